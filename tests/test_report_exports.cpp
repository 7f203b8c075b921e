// SPDX-License-Identifier: Apache-2.0
//
// What a run gives to other programs: tables, a Cinema database, .vti files, mosaics.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>

#include "core/color.h"
#include "core/image_io.h"
#include "eval/cell_vti.h"
#include "eval/cinema.h"
#include "eval/crop_mosaic.h"
#include "eval/csv.h"
#include "eval/error_map.h"
#include "eval/report_data.h"
#include "eval/report_exports.h"
#include "eval/report_tables.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/tiny_run.h"
#include "tests/vti_file.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;
using Table = std::vector<std::vector<std::string>>;

/// RFC 4180, with nothing of the writer.
Table parse_csv(const std::string& text) {
    Table table(1, {""});
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        std::string& field = table.back().back();
        if (quoted) {
            if (text[i] != '"') {
                field += text[i];
            } else if (i + 1 < text.size() && text[i + 1] == '"') {
                field += text[++i];
            } else {
                quoted = false;
            }
        } else if (text[i] == '"') {
            quoted = true;
        } else if (text[i] == ',') {
            table.back().emplace_back();
        } else if (text[i] == '\n') {
            table.push_back({""});
        } else {
            field += text[i];
        }
    }
    table.pop_back();  // after the last line's end
    return table;
}

/// Column by name, below its name.
std::vector<std::string> column(const Table& table, const std::string& name) {
    const auto found = std::ranges::find(table.front(), name);
    REQUIRE(found != table.front().end());
    const auto index = static_cast<std::size_t>(found - table.front().begin());
    std::vector<std::string> values;
    for (std::size_t i = 1; i < table.size(); ++i) values.push_back(table[i][index]);
    return values;
}

struct ExportedRun : TinyMatrix {
    ExportedRun() {
        json["axes"]["window"] = {3, 5};
        REQUIRE(run().failed == 0);
    }
    [[nodiscard]] ReportData data() const { return read_report_data(directory); }
    /// The same with a cell that failed as non-finite ones do.
    void fail_cell(const std::string& cell) const {
        auto changed = rows();
        Json& row = changed.at(cell);
        row["status"] = "failed";
        row["reason"] = "non-finite pixels";
        for (auto& [name, value] : row["metrics"].items()) value = nullptr;
        write_rows(changed);
    }
};

std::optional<ExitCode> exported(const ExportedRun& run, const std::string& output,
                                 const ReportExports& exports) {
    return run_exports(run.directory, output.empty() ? "" : run.temp.path(output), exports);
}

enum class Type { empty, integer, real, text };

/// As readers of Spec D tell them: what parses as a number is one.
Type type_of(const std::string& value) {
    if (value.empty()) return Type::empty;
    if (value == "NaN") return Type::real;
    if (value.find_first_not_of("-0123456789") == std::string::npos) return Type::integer;
    char* end = nullptr;
    (void)std::strtod(value.c_str(), &end);
    return *end == '\0' ? Type::real : Type::text;
}

}  // namespace

TEST_CASE("a Cinema database is one that Spec D allows", "[cinema]") {
    const ExportedRun run;
    run.fail_cell("box.mean.f2.w5.s2");
    REQUIRE(exported(run, "a.cdb/", {.vti = true}) == ExitCode::ok);
    const Table table = parse_csv(run.temp.read("a.cdb/data.csv"));
    REQUIRE(table.size() == 1 + run.rows().size());
    const std::vector<std::string>& names = table.front();
    CHECK(std::set<std::string>(names.begin(), names.end()).size() == names.size());
    bool files = false;
    for (const std::string& name : names) {
        CAPTURE(name);
        CHECK_FALSE(name.empty());
        CHECK(std::ranges::all_of(
            name, [](unsigned char c) { return c < 0x80 && (std::isalnum(c) != 0 || c == '_'); }));
        const bool is_file = name.starts_with("FILE");
        CHECK((is_file || !files));  // none after the first
        files = files || is_file;
        std::set<Type> types;
        for (const std::string& value : column(table, name)) types.insert(type_of(value));
        types.erase(Type::empty);
        CHECK(types.size() == 1);
    }
    for (const auto& row : table) CHECK(row.size() == names.size());
    CHECK(std::ranges::find(names, "FILE") != names.end());
    CHECK(std::vector(names.begin(), names.begin() + 2) ==
          std::vector<std::string>{"scene", "method"});
}

TEST_CASE("a Cinema database holds the run's values and files", "[cinema]") {
    const ExportedRun run;
    run.fail_cell("box.mean.f2.w5.s2");
    REQUIRE(exported(run, "a.cdb", {.vti = true}) == ExitCode::ok);
    const ReportData data = run.data();
    const Table table = parse_csv(run.temp.read("a.cdb/data.csv"));
    std::vector<std::string> cells;
    for (const std::string& image : column(table, "FILE"))
        cells.push_back(std::filesystem::path(image).stem().string());
    CHECK(std::set<std::string>(cells.begin(), cells.end()).size() == run.rows().size());
    const auto psnr = column(table, "psnr_float_db");
    const auto edge = column(table, "psnr_float_db_edge");
    const auto windows = column(table, "window");
    const auto seeds = column(table, "seed");
    for (std::size_t i = 0; i < cells.size(); ++i) {
        CAPTURE(cells[i]);
        const Json& row = data.row_of(cells[i]);
        CHECK(seeds[i] == row["seed"].dump());
        CHECK(windows[i] ==
              (row["params"].contains("window") ? row["params"]["window"].dump() : ""));
        const bool failed = cells[i] == "box.mean.f2.w5.s2";
        CHECK((psnr[i] == "NaN") == failed);
        CHECK((edge[i] == "NaN") == failed);
        if (!failed)
            CHECK(std::stod(psnr[i]) == Approx(row["metrics"]["psnr_float_db"].get<double>()));
        const std::string image = column(table, "FILE")[i];
        CHECK(image == "image/" + cells[i] + ".png");
        CHECK(run.temp.read("a.cdb/" + image) ==
              run.temp.read("run/cells/" + cells[i] + "/image.png"));
        for (const char* name : {"FILE_reference", "FILE_error", "FILE_error_signed"})
            CHECK_FALSE(load_image(run.temp.path("a.cdb/" + column(table, name)[i])).empty());
        const VtiRead vti = read_vti(run.temp.path("a.cdb/" + column(table, "FILE_vti")[i]));
        CHECK(vti.size == Extent{16, 12});
    }
}

TEST_CASE("a Cinema database can be made again, of part of the cells", "[cinema]") {
    const ExportedRun run;
    REQUIRE(exported(run, "a.cdb", {}) == ExitCode::ok);
    const std::string whole = run.temp.read("a.cdb/data.csv");
    CHECK(whole.find("FILE_vti") == std::string::npos);
    REQUIRE(exported(run, "a.cdb", {}) == ExitCode::ok);
    CHECK(run.temp.read("a.cdb/data.csv") == whole);
    REQUIRE(exported(run, "a.cdb", {.only = "w5"}) == ExitCode::ok);
    const Table part = parse_csv(run.temp.read("a.cdb/data.csv"));
    CHECK(part.size() == 1 + 2);
    CHECK(std::ranges::find(part.front(), "window") == part.front().end());  // all have the same
    // An error map that is older than its image is drawn again.
    const std::string map = run.directory + "/cells/box.mean.f2.w5.s1/error.png";
    std::filesystem::last_write_time(map, std::filesystem::file_time_type::min());
    REQUIRE(exported(run, "a.cdb", {.only = "w5"}) == ExitCode::ok);
    CHECK(std::filesystem::last_write_time(map) > std::filesystem::file_time_type::min());
    CHECK(error_of([&] { (void)exported(run, "a.cdb", {.only = "nothing"}); }).code() ==
          ExitCode::usage);
    run.temp.write("file.cdb", "");
    CHECK(error_of([&] { (void)exported(run, "file.cdb", {}); }).code() == ExitCode::file);
}

TEST_CASE("every cell of a run can be a .vti file", "[vti]") {
    const ExportedRun run;
    REQUIRE(exported(run, "", {.vti = true, .only = "mean.*s1"}) == ExitCode::ok);
    std::size_t found = 0;
    for (const Json& row : run.row_list()) {
        const std::string cell = row["cell"];
        const std::string file = run.directory + "/cells/" + cell + "/cell.vti";
        if (!std::filesystem::exists(file)) continue;
        ++found;
        const VtiRead read = read_vti(file);
        const Image image = load_image(run.image_file(cell));
        const Frame reference = run.reference(row);
        for (int y = 0; y < 12; ++y) {
            for (int x = 0; x < 16; ++x) {
                CHECK(read.at("test", x, y, 1) == image(x, y).y);
                CHECK(read.at("reference", x, y, 2) == reference.radiance(x, y).z);
                CHECK(read.at("reference_normal", x, y, 1) == reference.normal_world(x, y).y);
            }
        }
        CHECK(read.arrays.contains("region"));
        CHECK(read.head.find("Name=\"psnr_float_db\"") != std::string::npos);
    }
    CHECK(found == 2);  // two windows
}

TEST_CASE("summaries as CSV and JSON lines hold every group with its spread", "[report_tables]") {
    const ExportedRun run;
    REQUIRE(exported(run, "a.csv", {}) == ExitCode::ok);
    REQUIRE(exported(run, "a.jsonl", {}) == ExitCode::ok);
    const ReportData data = run.data();
    const Table table = parse_csv(run.temp.read("a.csv"));
    REQUIRE(table.size() == 1 + data.groups.size());
    CHECK(table.front().front() == "group");
    std::istringstream lines(run.temp.read("a.jsonl"));
    for (std::size_t i = 0; i < data.groups.size(); ++i) {
        const GroupSummary& group = data.groups[i];
        CAPTURE(group.group);
        std::string line;
        REQUIRE(std::getline(lines, line));
        const Json json = Json::parse(line);
        CHECK(json["group"] == group.group);
        CHECK(json["cells"] == group.cells);
        CHECK(column(table, "group")[i] == group.group);
        CHECK(std::stod(column(table, "psnr_float_db.mean")[i]) == group.psnr_float_db->mean);
        const std::string low = column(table, "psnr_float_db.low")[i];
        CHECK(low.empty() == (group.seeds < 2));
        if (!low.empty()) CHECK(std::stod(low) == *group.psnr_float_db->low);
        CHECK(json["psnr_float_db"]["low"].is_null() == low.empty());
        CHECK(json["time_s_min"].get<double>() <= json["time_s"].get<double>());
        CHECK(json["time_s_max"].get<double>() >= json["time_s"].get<double>());
        CHECK(column(table, "params.reduction")[i] == (group.method == "path" ? "" : "2"));
    }
}

TEST_CASE("a table of part of the groups keeps all of their seeds", "[report_tables]") {
    const ExportedRun run;
    REQUIRE(exported(run, "a.csv", {.only = "mean.*s1"}) == ExitCode::ok);
    const Table table = parse_csv(run.temp.read("a.csv"));
    CHECK(column(table, "group") == std::vector<std::string>{"box.mean.f2.w3", "box.mean.f2.w5"});
    CHECK(column(table, "seeds") == std::vector<std::string>{"2", "2"});
    REQUIRE(exported(run, "a.tex", {.only = "nearest"}) == ExitCode::ok);
    CHECK(run.temp.read("a.tex").find("mean}") == std::string::npos);
}

TEST_CASE("a chart of part of the groups has their marks alone", "[report_tables]") {
    const ExportedRun run;
    REQUIRE(exported(run, "a.png", {.only = "mean"}) == ExitCode::ok);
    const Image picture = load_image(run.temp.path("a.png"));
    const auto pixels_like = [&](glm::u8vec3 colour) {
        int count = 0;
        for (const glm::vec3& pixel : picture.values()) {
            const auto byte = [](float v) { return quantise_8bit(srgb_encode(v)); };
            count +=
                byte(pixel.x) == colour.x && byte(pixel.y) == colour.y && byte(pixel.z) == colour.z;
        }
        return count;
    };
    CHECK(pixels_like({185, 120, 0}) > 100);  // mean
    CHECK(pixels_like({11, 107, 176}) == 0);  // nearest
    CHECK(error_of([&] { (void)exported(run, "a.png", {.only = "nothing"}); }).code() ==
          ExitCode::usage);
}

TEST_CASE("what a field of CSV holds comes back", "[report_tables]") {
    const std::vector<Json> rows{{{"a", "x,\"y\"\r\nz"}, {"b", {{"c", {1, 2}}}}},
                                 {{"a", ""}, {"d", nullptr}, {"e", 0.5}}};
    const Table table = parse_csv(csv_text(rows, "a"));
    CHECK(table == Table{{"a", "b.c", "e"}, {"x,\"y\"\r\nz", "[1,2]", ""}, {"", "", "0.5"}});
    CHECK(csv_line({"", "b"}) == ",b\n");
}

TEST_CASE("LaTeX sets any text as it is", "[report_tables]") {
    CHECK(latex_text("a_b") == "a\\_b");
    CHECK(latex_text("\\{}$&#%_^~") ==
          "\\textbackslash{}\\{\\}\\$\\&\\#\\%\\_\\textasciicircum{}\\textasciitilde{}");
    CHECK(latex_text("<a>|\"b\"`'") ==
          "\\textless{}a\\textgreater{}\\textbar{}\\char34{}b\\char34{}\\textasciigrave{}"
          "\\textquotesingle{}");
    CHECK(latex_text("--x") == "-{}-x");
    CHECK(latex_text("512 × 512\n") == "512 $\\times$ 512 ");
    CHECK(latex_text("año") == "año");
}

TEST_CASE("a LaTeX table has a cell per column, and the best in bold", "[report_tables]") {
    const ExportedRun run;
    REQUIRE(exported(run, "a.tex", {}) == ExitCode::ok);
    std::istringstream text(run.temp.read("a.tex"));
    const ReportData data = run.data();
    std::size_t rows = 0;
    std::size_t bold = 0;
    for (std::string line; std::getline(text, line);) {
        if (!line.ends_with("\\\\")) continue;
        ++rows;
        // method, reduction, window, seeds, PSNR, interior, SSIM, relMSE, time, share
        CHECK(std::ranges::count(line, '&') == 9);
        if (line.find("\\textbf") != std::string::npos) ++bold;
    }
    CHECK(rows == 1 + data.groups.size());
    CHECK(bold > 0);
    const std::string tex = run.temp.read("a.tex");
    for (const char* part : {"\\toprule", "\\midrule", "\\bottomrule", "\\label{tab:tiny-box}",
                             "\\texttt{nearest}", "\\begin{tabular}{@{}l"})
        CHECK(tex.find(part) != std::string::npos);
    const auto best = std::ranges::max_element(data.groups, {}, [](const GroupSummary& group) {
        return group.params.contains("spp") ? group.psnr_float_db->mean : -1.0;
    });
    char mean[32];
    std::snprintf(mean, sizeof mean, "\\textbf{%.2f", best->psnr_float_db->mean);
    CHECK(tex.find(mean) != std::string::npos);
}

TEST_CASE("a mosaic shows each crop enlarged, framed and marked in the whole image", "[mosaic]") {
    const ExportedRun run;
    const ReportData data = run.data();
    const MosaicOptions options{{{2, 3, 4, 3}, {10, 6, 4, 3}}, {"psnr_float_db", "time_s"}};
    const auto rows = selected_rows(data, "f2.*s1");
    const Grid<glm::u8vec3> picture = crop_mosaic(data, rows, options);
    const auto count = [&](glm::u8vec3 colour) {
        return std::ranges::count(picture.values(), colour);
    };
    // Two pixels wide lines around 5 crops: the marker, reference and three results.
    CHECK(count({230, 159, 0}) > 4000);
    CHECK(count({86, 180, 233}) > 4000);
    CHECK(count({0, 158, 115}) == 0);  // the third crop's
    // The middle of each pixel of a crop is as the image has it, for each column at its place.
    const auto colour_of = [](glm::vec3 linear) {
        Image one({1, 1}, linear);
        const glm::vec3 display = display_image(one)(0, 0);
        return glm::u8vec3(255.0f * display + 0.5f);
    };
    const Image reference = run.reference(*rows.front()).radiance;
    std::set<std::pair<int, int>> places;
    for (int y = 0; y < picture.size().height; ++y)
        for (int x = 0; x < picture.size().width; ++x)
            if (picture(x, y) == colour_of(reference(3, 4))) places.insert({x, y});
    CHECK(places.size() > 900);  // a pixel of the crop covers 65 x 65
    CHECK(crop_mosaic(data, rows, options).values() == picture.values());
}

TEST_CASE("a mosaic without crops shows whole images, a block per scene", "[mosaic]") {
    TinyMatrix run;
    run.copy_scene("other");
    run.json["axes"]["scene"] = {"box.json", "other.json"};
    REQUIRE(run.run().failed == 0);
    const ReportData data = read_report_data(run.directory);
    const MosaicOptions options{{}, {"ssim"}};
    const auto one = crop_mosaic(data, selected_rows(data, "^box.*s1"), options);
    const auto two = crop_mosaic(data, selected_rows(data, "s1"), options);
    CHECK(two.size() == Extent{one.size().width, 2 * one.size().height});
    // Another seed of a group is no column of its own.
    CHECK(crop_mosaic(data, selected_rows(data, "^box.*s[12]"), options).size() == one.size());
}

TEST_CASE("a mosaic that cannot be is refused in a line", "[mosaic]") {
    const ExportedRun run;
    const auto refused = [&](const std::string& output, const ReportExports& exports) {
        const Error error = error_of([&] { (void)exported(run, output, exports); });
        CHECK(error.code() == ExitCode::usage);
        return std::string(error.what());
    };
    CHECK(refused("a.png", {.mosaic = true, .crops = {"1,2,3"}}) ==
          "command line: --crop: found \"1,2,3\", allowed: X,Y,WIDTH,HEIGHT in pixels, such as "
          "10,20,64,48");
    for (const char* crop :
         {"", "1,2,0,3", "-1,2,3,4", "1,2,3,4,", "1,2,3,4 ", "a,b,c,d", "1.5,2,3,4"}) {
        CAPTURE(crop);
        CHECK(refused("a.png", {.mosaic = true, .crops = {crop}}).find("--crop: found") !=
              std::string::npos);
    }
    CHECK(refused("a.png", {.mosaic = true, .crops = {"10,10,7,2"}}) ==
          "command line: --crop: found one that ends at 17,12, allowed: within the image of box, "
          "16x12");
    CHECK(refused("a.png", {.mosaic = true, .metrics = {"psnr"}})
              .find("--metric: found \"psnr\", allowed: psnr_float_db, ") != std::string::npos);
    CHECK(refused("a.csv", {.mosaic = true}).find("--mosaic: found without") != std::string::npos);
    CHECK(refused("a.png", {.crops = {"0,0,1,1"}}).find("--crop: found without --mosaic") !=
          std::string::npos);
    CHECK(refused("a.png", {.metrics = {"ssim"}}).find("--metric: found without --mosaic") !=
          std::string::npos);
    CHECK(refused("a.md", {.only = "s1"}).find("--only: found without") != std::string::npos);
    CHECK(refused("a.png", {.mosaic = true, .only = "("}).find("--only: found \"(\"") !=
          std::string::npos);
    CHECK_FALSE(std::filesystem::exists(run.temp.path("a.png")));
    CHECK_FALSE(exported(run, "a.html", {}));
    CHECK_FALSE(exported(run, "", {}));
}
