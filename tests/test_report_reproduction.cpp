// SPDX-License-Identifier: Apache-2.0
//
// What a report says of the publication that its matrix reproduces.
#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "eval/html_text.h"
#include "eval/report.h"
#include "eval/report_data.h"
#include "eval/report_pictures.h"
#include "eval/run_plan.h"
#include "tests/catch.h"
#include "tests/page_text.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

// What a text of a matrix may hold.
const std::string kEvil = "</script><script>alert(2)</script><b onload=\"y\">&'";

Json item_json(const std::string& id, const Json& more) {
    Json item = {{"id", id},      {"section", "1" + kEvil}, {"text", "number" + kEvil},
                 {"unit", "min"}, {"quantity", "time"},     {"published", 30}};
    item.update(more);
    return item;
}

Json claim_of(const std::string& id, const Json& of, const Json& than) {
    const Json test = {{"quantity", "quality"}, {"of", of}, {"is", "higher"}, {"than", than}};
    return {{"id", id},
            {"section", "2" + kEvil},
            {"text", "claim" + kEvil},
            {"note", "note" + kEvil},
            {"tests", Json::array({test})}};
}

Json figure_json(const std::string& id, const std::string& kind, const Json& of) {
    return {{"id", id}, {"title", "title" + kEvil}, {"kind", kind}, {"of", of}};
}

Json reproduction_part() {
    const Json path = {{"method", "path"}};
    const Json mean = {{"method", "mean"}};
    const Json share = {
        {"unit", "%"}, {"quantity", "largest_time_share"}, {"of", mean}, {"within", 5}};
    return {{"source", "a book" + kEvil},
            {"variants",
             {{{"id", "far"}, {"label", "far" + kEvil}, {"where", {{"weighting", "proportional"}}}},
              {{"id", "near"}, {"label", "near" + kEvil}, {"where", {{"weighting", "inverse"}}}}}},
            {"items", {item_json("share", share), item_json("minutes", {{"of", path}})}},
            {"claims",
             {claim_of("better", mean, path), claim_of("worse", path, mean),
              claim_of("lost", {{"method", "distance3d"}}, path),
              claim_of("window", {{"window", 5}}, {{"window", 3}})}},
            {"graphs",
             {{{"id", "graph" + kEvil}, {"title", "times" + kEvil}, {"of", mean}},
              {{"id", "all"}, {"title", "all"}, {"of", Json::object()}}}},
            {"figures",
             {figure_json("mosaic" + kEvil, "mosaic", {path, mean}),
              figure_json("references", "reference", Json::array()),
              figure_json("light", "light", {{"scene", "hall"}}),
              figure_json("strips", "strips", {{"scene", "box"}, {"method", "path"}}),
              figure_json("lost", "mosaic", {{"method", "distance3d"}})}}};
}

/// Path tracing and two schemes on two scenes.
struct BookRun : TinyMatrix {
    explicit BookRun(bool reproduces = true) {
        copy_scene("hall");
        json["axes"] = {{"scene", {"box.json", "hall.json"}},
                        {"scheme", {"mean", "distance2d"}},
                        {"reduction", 2},
                        {"window", {3, 5}},
                        {"seed", {1, 2, 3}}};
        json["include"] = {{{"scheme", "distance2d"}, {"weighting", "inverse"}},
                           {{"method", "path"}, {"spp", {1, 4}}}};
        if (reproduces) json["reproduction"] = reproduction_part();
        run();
    }

    [[nodiscard]] ReportData data() const { return read_report_data(directory); }
    [[nodiscard]] std::string page() const { return read_file(write_report(data())); }
};

std::string row_of(const std::string& page, const std::string& id) {
    // A claim's row holds a table of pairs: up to the next row with an id, or the section's end.
    const std::string rest = between(page, "<tr id=\"" + id + "\">", "</section>");
    return rest.substr(0, rest.find("<tr id="));
}

std::string figure_of(const std::string& page, const std::string& id) {
    return between(page, "<figure class=\"figure\" id=\"" + escaped(id) + "\">", "</figure>");
}

std::string unescaped(std::string text) {
    for (const char c : std::string("<>\"'&")) {
        const std::string reference = escaped(std::string(1, c));
        for (auto at = text.find(reference); at != std::string::npos; at = text.find(reference))
            text.replace(at, reference.size(), std::string(1, c));
    }
    return text;
}

/// Names of the cells that the command in a row would run in an empty directory.
std::set<std::string> commanded(const std::string& row, const Matrix& matrix) {
    const std::string command = unescaped(between(row, "Made again by <code>", "</code>"));
    RunOptions options;
    if (has(command, " --only ")) options.only = between(command, " --only '", "'");
    const auto cells = expand(matrix);
    std::set<std::string> names;
    for (const PlannedCell& planned :
         plan_run(cells, options, [](const Cell&) { return CellState::missing; }))
        if (planned.run) names.insert(planned.cell->name);
    return names;
}

std::set<std::string> cells_of(const Matrix& matrix, const std::set<std::string>& methods) {
    std::set<std::string> names;
    for (const Cell& cell : expand(matrix))
        if (methods.contains(cell.method())) names.insert(cell.name);
    return names;
}

/// Groups of the panels of a mosaic, in order.
Names panels_of(const std::string& figure, const ReportData& data) {
    Names names;
    const std::string mark = "</div><a href=\"#g";
    for (auto at = figure.find(mark); at != std::string::npos; at = figure.find(mark, at + 1))
        names.push_back(data.groups.at(std::stoul(figure.substr(at + mark.size()))).group);
    return names;
}

}  // namespace

TEST_CASE("a report holds the verdict of every number and every claim", "[report_reproduction]") {
    const BookRun run;
    const ReportData data = run.data();
    const std::string page = run.page();
    const Json json = Json::parse(run.temp.read("run/reproduction.json"));
    CHECK(json == reproduction_json(data.reproduction->specification, data.reproduction->result));
    REQUIRE(json["items"].size() == 2);
    REQUIRE(json["claims"].size() == 4);
    for (const Json& item : json["items"]) {
        const std::string row = row_of(page, "item-" + item["id"].get<std::string>());
        CHECK(has(row, " " + item["verdict"].get<std::string>() + "</span>"));
        CHECK(has(row, escaped("number" + kEvil)));
    }
    std::set<std::string> verdicts;
    for (const Json& claim : json["claims"]) {
        const std::string row = row_of(page, "claim-" + claim["id"].get<std::string>());
        CHECK(has(row, escaped("claim" + kEvil)));
        CHECK(has(row, escaped("note" + kEvil)));
        // Two variants, whole and interior.
        REQUIRE(claim["results"].size() == 4);
        std::size_t at = row.find("</details>");
        for (const Json& result : claim["results"]) {
            const std::string verdict = result["verdict"];
            at = row.find(" " + verdict + "</span>", at);
            REQUIRE(at != std::string::npos);
            verdicts.insert(verdict);
            for (const Json& pair : result["pairs"])
                CHECK(has(row, ">" + pair["of"].get<std::string>() + "</a>"));
        }
    }
    CHECK(verdicts.contains("not testable"));
    CHECK(verdicts.size() > 1);
}

TEST_CASE("a claim's opposite has the opposite outcomes", "[report_reproduction]") {
    const BookRun run;
    const ReportData data = run.data();
    const auto& claims = data.reproduction->result.claims;
    const ClaimResult& better = claims[0][0];
    const ClaimResult& worse = claims[1][0];
    CHECK(better.pairs.size() == 2 * 2);
    CHECK(better.missing == 0);
    CHECK(better.holds == worse.fails);
    CHECK(better.fails == worse.holds);
    CHECK(claims[2][0].verdict == ClaimVerdict::not_testable);
}

TEST_CASE("the command beside a number or a claim makes the cells that it speaks of",
          "[report_reproduction]") {
    const BookRun run;
    const std::string page = run.page();
    const Matrix matrix = run.load();
    const auto of = [&](const std::set<std::string>& methods) { return cells_of(matrix, methods); };
    CHECK(commanded(row_of(page, "claim-better"), matrix) == of({"path", "mean"}));
    CHECK(commanded(row_of(page, "item-share"), matrix) == of({"path", "mean"}));
    CHECK(commanded(row_of(page, "item-minutes"), matrix) == of({"path"}));
    // One that names no method may speak of any.
    CHECK(commanded(row_of(page, "claim-window"), matrix) ==
          of({"path", "mean", "distance2d", "blocky_ceiling"}));
}

TEST_CASE("figures show the pictures that they speak of", "[report_reproduction]") {
    const BookRun run;
    const ReportData data = run.data();
    const std::string page = run.page();
    // Path tracing first, as asked; the same parameters of both scenes side by side.
    CHECK(panels_of(figure_of(page, "mosaic" + kEvil), data) ==
          Names{"box.path", "hall.path", "box.mean.f2.w3", "hall.mean.f2.w3", "box.mean.f2.w5",
                "hall.mean.f2.w5"});
    const std::string references = figure_of(page, "references");
    CHECK(count(references, "<img class=\"whole\"") == 2);
    CHECK(count(references, "src=\"data:image/png;base64,") == 2);
    CHECK(has(references, "<small>hall</small>"));
    const std::string light = figure_of(page, "light");
    CHECK(count(light, "src=\"data:image/png;base64,") == 3);
    for (const char* label : {"direct", "indirect", "global: emitted, direct and indirect"})
        CHECK(has(light, "<small>" + std::string(label) + "</small>"));
    const std::string strips = figure_of(page, "strips");
    CHECK(count(strips, "src=\"data:image/png;base64,") == 3);
    CHECK(strips.find(">1 spp<") < strips.find(">4 spp<"));
    CHECK(strips.find(">4 spp<") < strips.find(">8 spp<"));
    CHECK(has(figure_of(page, "lost"), "No result of this run belongs here."));
}

TEST_CASE("strips are bands of one picture, each of its own number of samples",
          "[report_reproduction]") {
    const BookRun run;
    const auto pictures = make_report_pictures(run.data()).figures.at("strips");
    REQUIRE(pictures.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        const Names cells{"box.path.spp1.s1", "box.path.spp4.s1", "box.path.s1"};
        const Image whole = load_image(run.image_file(cells[i]));
        Image band({16, 4});
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 16; ++x) band(x, y) = whole(x, 4 * static_cast<int>(i) + y);
        save_image(band, run.temp.path("band.png"));
        CHECK(pictures[i].url == png_url(read_file(run.temp.path("band.png"))));
    }
}

TEST_CASE("a strip is of a seed that was finished", "[report_reproduction]") {
    const BookRun run;
    const auto before = make_report_pictures(run.data()).figures.at("strips");
    auto rows = run.rows();
    rows.at("box.path.s1")["status"] = "failed";
    run.write_rows(rows);
    Image broken({16, 12});
    broken(3, 10).x = std::numeric_limits<float>::quiet_NaN();
    save_image(broken, run.image_file("box.path.s1"));
    const auto after = make_report_pictures(run.data()).figures.at("strips");
    REQUIRE(after.size() == 3);
    CHECK(after[0].url == before[0].url);
    CHECK(after[2].url != before[2].url);
}

TEST_CASE("graphs are drawn from the times of the groups that they speak of",
          "[report_reproduction]") {
    const BookRun run;
    const std::string page = run.page();
    const ReportData data = run.data();
    const Json graphs = embedded_data(page)["graphs"];
    REQUIRE(graphs.size() == 2);
    CHECK(graphs[0]["id"] == "graph" + kEvil);
    CHECK(has(page, "data-graph=\"" + escaped("graph" + kEvil) + "\""));
    Names labels;
    for (const Json& bar : graphs[0]["bars"]) {
        const std::string id = bar["id"];
        const GroupSummary& group = data.groups.at(std::stoul(id.substr(1)));
        CHECK(bar["scene"] == group.scene);
        CHECK(bar["time_s"] == group.time_s);
        labels.push_back(group.scene + " " + bar["label"].get<std::string>());
    }
    CHECK(labels ==
          Names{"box path", "hall path", "box f2.w3", "box f2.w5", "hall f2.w3", "hall f2.w5"});
    // Path tracing stands there once, be it asked for or not; no other variant does.
    CHECK(graphs[1]["bars"].size() == 2 * (1 + 2 + 2));
}

TEST_CASE("no text of a reproduction can add to a report's HTML", "[report_reproduction]") {
    const BookRun run, plain(false);
    const std::string page = run.page();
    CHECK_FALSE(has(page, "<b onload"));
    CHECK_FALSE(has(page, "<script>alert"));
    CHECK(has(page, escaped("a book" + kEvil)));
    CHECK(count(page, "<script") == count(plain.page(), "<script"));
    CHECK(count(page, "</script") == count(plain.page(), "</script"));
}

TEST_CASE("a report of a matrix that claims nothing has no word of it", "[report_reproduction]") {
    const BookRun run(false);
    const std::string page = run.page();
    for (const char* id : {"reproduction", "graphs", "figures"}) {
        CHECK_FALSE(has(page, "id=\"" + std::string(id) + "\""));
        CHECK_FALSE(has(page, "href=\"#" + std::string(id) + "\""));
    }
    CHECK_FALSE(has(page, "class=\"verdict"));
    CHECK(embedded_data(page)["graphs"].empty());
    CHECK_FALSE(std::filesystem::exists(run.temp.path("run/reproduction.json")));
}

TEST_CASE("a report links to those sections that it has", "[report_reproduction]") {
    BookRun run;
    for (const char* part : {"graphs", "figures"}) {
        run.json["reproduction"].erase(part);
        run.run();
        const std::string page = run.page();
        CHECK(has(page, "href=\"#reproduction\""));
        CHECK_FALSE(has(page, "href=\"#" + std::string(part) + "\""));
        CHECK_FALSE(has(page, "id=\"" + std::string(part) + "\""));
    }
}
