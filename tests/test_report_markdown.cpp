// SPDX-License-Identifier: Apache-2.0
//
// A run as Markdown tables, and as single pictures.
#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "core/image_io.h"
#include "eval/report.h"
#include "eval/report_raster.h"
#include "eval/report_sections.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

const std::string kEvil = "a|b `c` *d* <e>\n[f]";

struct MarkdownRun : TinyMatrix {
    MarkdownRun() {
        json["axes"]["seed"] = 1;
        json["include"] = {{{"spp", 2}, {"seed", {1, 2, 3}}}};
        const Json path = {{"method", "path"}};
        const Json mean = {{"method", "mean"}};
        json["reproduction"] = {
            {"source", "a book " + kEvil},
            {"variants",
             {{{"id", "printed"}, {"label", "printed " + kEvil}, {"tested_at", {{"spp", 2}}}}}},
            {"items",
             {{{"id", "i"},
               {"section", "1"},
               {"text", "share " + kEvil},
               {"published", 25},
               {"unit", "%"},
               {"quantity", "largest_time_share"},
               {"of", mean},
               {"within", 5}}}},
            {"claims",
             {{{"id", "c"},
               {"section", "2"},
               {"text", "claim " + kEvil},
               {"note", "note " + kEvil},
               {"tests",
                {{{"quantity", "quality"}, {"of", mean}, {"is", "higher"}, {"than", path}}}}}}},
            {"figures",
             {{{"id", "two"}, {"title", "two"}, {"of", {path, mean}}},
              {{"id", "all"}, {"title", "all"}, {"kind", "reference"}},
              {{"id", "lost"}, {"title", "lost"}, {"of", {{"method", "distance3d"}}}}}}};
        REQUIRE(run().failed == 0);
    }
    [[nodiscard]] ReportData data() const { return read_report_data(directory); }
};

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

/// Bars that end a cell.
std::size_t bars(const std::string& line) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < line.size(); ++i)
        count += line[i] == '|' && (i == 0 || line[i - 1] != '\\') ? 1 : 0;
    return count;
}

std::string line_with(const std::string& text, const std::string& part) {
    for (const std::string& line : lines_of(text))
        if (line.find(part) != std::string::npos) return line;
    return "";
}

std::size_t pixels_of(const Grid<glm::u8vec3>& picture, glm::u8vec3 colour) {
    return static_cast<std::size_t>(std::ranges::count(picture.values(), colour));
}

}  // namespace

TEST_CASE("every row of a Markdown table has the columns of its head", "[report_markdown]") {
    const MarkdownRun run;
    const auto lines = lines_of(report_markdown(run.data()));
    std::size_t tables = 0;
    std::size_t columns = 0;
    for (const std::string& line : lines) {
        const bool is_row = line.starts_with("|");
        if (is_row && columns == 0) {
            columns = bars(line);
            ++tables;
        }
        if (is_row) CHECK(bars(line) == columns);
        if (!is_row) columns = 0;
    }
    CHECK(tables == 6);  // facts, tally, numbers, claims, results of one scene, references
}

TEST_CASE("Markdown tells what was published, what came out, and at which samples",
          "[report_markdown]") {
    const MarkdownRun run;
    const ReportData data = run.data();
    const std::string text = report_markdown(data);
    for (const char* title : {"# tiny", "## What holds of", "## Numbers", "## Claims", "## Results",
                              "### box", "## References"})
        CHECK(line_with(text, title).starts_with(title));
    CHECK(
        line_with(text, "| § | what").find("ours (spp 8, seed 1) | ours (spp 2, seeds 1, 2, 3)") !=
        std::string::npos);
    CHECK(line_with(text, "| § | claim").find("ours, dB (spp 2, seeds 1, 2, 3)") !=
          std::string::npos);
    const std::string claim = line_with(text, "| 2 | claim");
    const auto& result = data.reproduction->result.claims.at(0).at(0);
    CHECK(claim.find("| " + verdict_text(result.verdict) + " |") != std::string::npos);
    CHECK(claim.find(" ± ") != std::string::npos);
    CHECK(result.pairs.at(0).published_db);
    CHECK(line_with(text, "| Seeds").find("1 at 8 spp; 1, 2, 3 at 2 spp") != std::string::npos);
    CHECK(line_with(text, "`mean.f2.w3.spp2`").find("| 3 | 2 |") != std::string::npos);
    CHECK(line_with(text, "| box | whole |").find("`box.") != std::string::npos);
}

TEST_CASE("nothing in a Markdown cell is markup, or ends it", "[report_markdown]") {
    const MarkdownRun run;
    const std::string text = report_markdown(run.data());
    CHECK(text.find("a|b") == std::string::npos);
    CHECK(text.find("<e>") == std::string::npos);
    CHECK(line_with(text, "claim a").find(R"(claim a\|b \`c\` \*d\* \<e\> \[f\])") !=
          std::string::npos);
}

TEST_CASE("a report's format follows from its name, and its bytes from the run",
          "[report_markdown]") {
    const MarkdownRun run;
    const std::string file = run.temp.path("out.md");
    CHECK(write_report(run.data(), file) == file);
    CHECK(run.temp.read("out.md") == report_markdown(run.data()));
    CHECK_FALSE(std::filesystem::exists(run.directory + "/cells/box.path.s1/error.png"));
    (void)write_report(run.data(), run.temp.path("out.html"));
    CHECK(run.temp.read("out.html").find("<html") != std::string::npos);
}

TEST_CASE("a run without claims has results and references alone", "[report_markdown]") {
    const TinyMatrix run;
    run.run();
    const std::string text = report_markdown(read_report_data(run.directory));
    CHECK(text.find("## Claims") == std::string::npos);
    CHECK(text.find("## Results") != std::string::npos);
}

TEST_CASE("a figure is drawn as its reference and its results side by side", "[report_markdown]") {
    const MarkdownRun run;
    const Grid<glm::u8vec3> picture = mosaic_raster(run.data(), "two");
    CHECK(picture.size() == Extent{3 * 210 + 10, 200 + 46 + 20});
    const auto is_paper = [&](int x, int y) { return picture(x, y) == glm::u8vec3(255); };
    for (int panel = 0; panel < 3; ++panel) CHECK_FALSE(is_paper(10 + 210 * panel + 20, 10 + 20));
    CHECK(is_paper(5, 5));
    // The same picture again is the same; another cell's is not.
    CHECK(mosaic_raster(run.data(), "two").values() == picture.values());
    const Error unknown = error_of([&] { (void)mosaic_raster(run.data(), "all"); });
    CHECK(unknown.code() == ExitCode::usage);
    CHECK(std::string(unknown.what()) ==
          "command line: --figure: found \"all\", allowed: two, lost");
    CHECK(error_of([&] { (void)mosaic_raster(run.data(), "lost"); }).code() == ExitCode::file);
}

TEST_CASE("the chart holds a mark of every method of the first variant", "[report_markdown]") {
    const MarkdownRun run;
    const Grid<glm::u8vec3> picture = chart_raster(run.data());
    CHECK(pixels_of(picture, {26, 29, 33}) > 20);     // path tracing and text
    CHECK(pixels_of(picture, {11, 107, 176}) > 100);  // nearest
    CHECK(pixels_of(picture, {185, 120, 0}) > 100);   // mean
    CHECK(pixels_of(picture, {0, 134, 106}) == 0);    // distance2d is not in the run
    write_report_picture(run.data(), run.temp.path("chart.png"), "");
    CHECK(load_image(run.temp.path("chart.png")).size() == picture.size());
}
