// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/image_io.h"
#include "eval/error_map.h"
#include "eval/html_text.h"
#include "eval/report.h"
#include "eval/report_data.h"
#include "eval/report_pictures.h"
#include "eval/run_matrix.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/page_text.h"
#include "tests/result_rows.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

// What a run's names may hold on a file system, and what its texts may hold anywhere.
const std::string kOddScene = "box<b onload=\"x\">&'";
const std::string kOddName = "</script><script>alert(1)</script>";

/// A run of path tracing and two schemes with two seeds each, made in a directory of its own.
struct TinyRun {
    TempDir temp;
    std::string directory = temp.path("run");

    TinyRun() {
        temp.write(kOddScene + ".json",
                   read_file(std::string(VECINO_SOURCE_DIR) + "/scenes/cornell.json"));
        const nlohmann::json matrix = {
            {"name", kOddName},
            {"axes",
             {{"scene", {kOddScene + ".json"}}, {"scheme", {"nearest", "mean"}}, {"seed", {1, 2}}}},
            {"fixed", {{"size", {8, 8}}, {"spp", 64}, {"reduction", 2}}},
            {"reference", {{"spp", 256}, {"seed", 9}}}};
        run_matrix(load_matrix(temp.write("tiny.json", matrix.dump())), directory);
    }

    [[nodiscard]] Image image(const std::string& cell_name) const {
        return load_image(directory + "/cells/" + cell_name + "/image.exr");
    }
    [[nodiscard]] Image reference(const ReportData& data) const {
        return load_image(directory + "/" + data.rows[0]["reference_file"].get<std::string>() +
                          ".exr");
    }
    [[nodiscard]] std::string page() const {
        return read_file(write_report(read_report_data(directory)));
    }
    [[nodiscard]] std::string cell(const std::string& name) const {
        return directory + "/cells/" + kOddScene + "." + name + "/";
    }
};

/// A report of rows without images.
std::string page_of(const std::vector<nlohmann::json>& rows) {
    const TempDir temp;
    std::string lines;
    for (const nlohmann::json& row : rows) lines += row.dump() + "\n";
    temp.write("results.jsonl", lines);
    return read_file(write_report(read_report_data(temp.path(""))));
}

/// The table row of a group of result_row().
std::string table_row(const std::string& page, const std::string& group) {
    return between(page, "data-words=\"" + group, "</tr>");
}

std::string table_head(const std::string& page) {
    return between(page, "<thead>", "</thead>");
}

}  // namespace

TEST_CASE("a report stands in its run directory and holds every group", "[report]") {
    const TinyRun run;
    CHECK(write_report(read_report_data(run.directory)) == run.directory + "/report.html");
    const std::string page = read_file(run.directory + "/report.html");
    for (const char* group : {".path", ".nearest.f2", ".mean.f2.w3"}) {
        CAPTURE(group);
        CHECK(has(page, "data-name=\"" + escaped(kOddScene + group) + "\""));
        CHECK(has(page, "data-words=\"" + escaped(kOddScene + group)));
    }
}

TEST_CASE("a report goes where it is asked to", "[report]") {
    const TinyRun run;
    const std::string elsewhere = run.temp.path("other.html");
    CHECK(write_report(read_report_data(run.directory), elsewhere) == elsewhere);
    CHECK(has(read_file(elsewhere), "</html>"));
    CHECK_FALSE(std::filesystem::exists(run.directory + "/report.html"));
}

TEST_CASE("the data in a report are JSON with a record of every group", "[report]") {
    const TinyRun run;
    const nlohmann::json data = embedded_data(run.page());
    REQUIRE(data["groups"].size() == 4);  // with the ceiling
    CHECK(data["groups"][0]["group"] == kOddScene + ".path");
    CHECK(data["groups"][1]["group"] == kOddScene + ".blocky_ceiling.f2");
    CHECK(data["groups"][3]["group"] == kOddScene + ".mean.f2.w3");
    CHECK(data["groups"][2]["seeds"] == 2);
    CHECK(data["groups"][2]["psnr_float_db"]["mean"].get<double>() > 0);
    CHECK(data["scenes"] == nlohmann::json{kOddScene});
    CHECK(data["methods"].size() == 4);
}

TEST_CASE("methods differ in shape or in colour", "[report]") {
    const nlohmann::json data = embedded_data(
        page_of({result_row("path", 1), result_row("nearest", 1), result_row("mean", 1),
                 result_row("distance2d", 1), result_row("distance3d", 1),
                 result_row("distance3d_normal", 1), result_row("of_tomorrow", 1)}));
    std::set<std::pair<std::string, int>> looks;
    for (const nlohmann::json& method : data["methods"])
        looks.emplace(method["shape"].get<std::string>(), method["colour"].get<int>());
    CHECK(looks.size() == 7);
}

TEST_CASE("a report loads nothing from outside of its file", "[report]") {
    const TinyRun run;
    const std::string page = run.page();
    CHECK(has(page, "content=\"default-src 'none'; img-src data:;"));
    for (const std::string attribute : {"src=\"", "href=\""}) {
        const std::size_t here = count(page, attribute + "data:") + count(page, attribute + "#");
        CHECK(count(page, attribute) == here);
    }
    CHECK_FALSE(has(page, "@import"));
    CHECK_FALSE(has(page, "url("));
    CHECK(has(page, "src=\"data:image/png;base64,iVBORw0KGgo"));
}

TEST_CASE("no name in a run can add to a report's HTML", "[report]") {
    const TinyRun run;
    const std::string page = run.page();
    CHECK_FALSE(has(page, "<b onload"));
    CHECK_FALSE(has(page, "alert(1)</script>"));
    CHECK(has(page, "box&lt;b onload=&quot;x&quot;&gt;&amp;&#39;"));
    CHECK(has(page, "<h1>&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;</h1>"));
    // The data, Chart.js and the page's own ten scripts.
    CHECK(count(page, "<script") == 12);
    CHECK(count(page, "</script") == 12);
}

TEST_CASE("every cell with an image gets both error maps, and nothing else", "[report]") {
    const TinyRun run;
    write_report(read_report_data(run.directory));
    for (const char* name : {"path.s1", "path.s2", "nearest.f2.s1", "nearest.f2.s2",
                             "mean.f2.w3.s1", "mean.f2.w3.s2"}) {
        CAPTURE(name);
        std::set<std::string> files;
        for (const auto& entry : std::filesystem::directory_iterator(run.cell(name))) {
            files.insert(entry.path().filename().string());
        }
        CHECK(files ==
              std::set<std::string>{"error.png", "error_signed.png", "image.exr", "image.png"});
        CHECK(load_image(run.cell(name) + "error.png").size().width > 384);
    }
}

TEST_CASE("all error maps share the median of their ranges", "[report]") {
    CHECK(shared_range({0.5f}) == 0.5f);
    CHECK(shared_range({1.0f, 0.1f, 0.2f}) == 0.2f);
    CHECK(shared_range({1.0f, 0.1f, 0.2f, 0.5f}) == 0.5f);
    const TinyRun run;
    const ReportData data = read_report_data(run.directory);
    const Image reference = run.reference(data);
    std::vector<float> magnitudes;
    std::vector<float> signs;
    for (const nlohmann::json& row : data.rows) {
        const Image image = run.image(row["cell"]);
        magnitudes.push_back(suggested_range(error_values(image, reference, ErrorKind::magnitude)));
        signs.push_back(suggested_range(error_values(image, reference, ErrorKind::sign)));
    }
    const ReportPictures pictures = make_report_pictures(data);
    CHECK(pictures.magnitude_range == shared_range(magnitudes));
    CHECK(pictures.sign_range == shared_range(signs));
}

TEST_CASE("a report shows the image and the bare maps of the first seed of each group",
          "[report]") {
    const TinyRun run;
    const ReportData data = read_report_data(run.directory);
    const ReportPictures pictures = make_report_pictures(data);
    REQUIRE(pictures.by_group.size() == 4);
    const GroupPictures& shown = pictures.by_group.at(kOddScene + ".mean.f2.w3");
    REQUIRE(shown.cell == kOddScene + ".mean.f2.w3.s1");
    CHECK(shown.image == png_url(read_file(run.cell("mean.f2.w3.s1") + "image.png")));

    const std::string file = run.temp.path("map.png");
    const auto map_url = [&](ErrorKind kind, float range) {
        const auto values = error_values(run.image(shown.cell), run.reference(data), kind);
        save_raster(error_colours(values, {kind, range, ""}), file);
        return png_url(read_file(file));
    };
    CHECK(shown.magnitude == map_url(ErrorKind::magnitude, pictures.magnitude_range));
    CHECK(shown.sign == map_url(ErrorKind::sign, pictures.sign_range));
}

TEST_CASE("a failed cell is listed with its reason and takes no picture's place", "[report]") {
    const TinyRun run;
    ReportData data = read_report_data(run.directory);
    const std::string failed = kOddScene + ".nearest.f2.s1";
    std::string lines;
    for (nlohmann::json row : data.rows) {
        if (row["cell"] == failed) {
            row["status"] = "failed";
            row["reason"] = "too <dark>";
            for (const char* key : {"metrics", "time_s", "counts"}) row.erase(key);
        }
        lines += row.dump() + "\n";
    }
    run.temp.write("run/results.jsonl", lines);
    const std::string page = run.page();
    CHECK(has(page, "<code>" + escaped(failed) + "</code></th><td>too &lt;dark&gt;</td>"));
    CHECK(has(page, "1 failed"));
    const ReportPictures pictures = make_report_pictures(read_report_data(run.directory));
    CHECK(pictures.by_group.at(kOddScene + ".nearest.f2").cell == kOddScene + ".nearest.f2.s2");
}

TEST_CASE("pixels that are not finite are told in the colour bars", "[report]") {
    const TinyRun run;
    CHECK_FALSE(has(run.page(), "bar nan"));
    Image image = load_image(run.cell("path.s2") + "image.exr");
    image(3, 3).x = std::numeric_limits<float>::quiet_NaN();
    save_image(image, run.cell("path.s2") + "image.exr");
    CHECK(has(run.page(), "bar nan"));
}

TEST_CASE("cells without images are reported without pictures", "[report]") {
    const std::string page = page_of({result_row("path", 1), failed_row("mean", 1, "no light")});
    CHECK(count(page, "<span>no picture</span>") == 6);
    CHECK_FALSE(has(page, "class=\"bars\""));
    CHECK(has(page, "<td>no light</td>"));
}

TEST_CASE("a report needs results, and says which file lacks them", "[report]") {
    const TempDir temp;
    const auto missing = error_of([&] { read_report_data(temp.path("nowhere")); });
    CHECK(missing.code() == ExitCode::file);
    CHECK(has(missing.what(), "nowhere/results.jsonl"));

    temp.write("results.jsonl", "\n");
    const auto empty = error_of([&] { write_report(read_report_data(temp.path(""))); });
    CHECK(empty.code() == ExitCode::file);
    CHECK(has(empty.what(), "holds no results"));
    CHECK_FALSE(std::filesystem::exists(temp.path("report.html")));
}

TEST_CASE("a row that lacks something is an error that names the cell and what it lacks",
          "[report]") {
    for (const char* key : {"group", "scene", "method", "status", "params", "metrics", "time_s"}) {
        CAPTURE(key);
        nlohmann::json row = result_row("mean", 1);
        row.erase(key);
        const auto error = error_of([&] { page_of({row}); });
        CHECK(error.code() == ExitCode::file);
        CHECK(has(error.what(), std::string("row of cell box.mean.s1 lacks ") + key));
    }
}

TEST_CASE("a first run that was killed, without run.json, has a report", "[report]") {
    const std::string page = page_of({result_row("path", 1)});
    CHECK(has(page, "not finished"));
    CHECK(embedded_data(page)["groups"].size() == 1);
}

TEST_CASE("the command in a report names its matrix and its directory", "[report]") {
    const TempDir temp;
    temp.write("results.jsonl", result_row("path", 1).dump() + "\n");
    temp.write("run.json", R"({"command": "vecino run configs/a.json", "cells": 5})");
    const std::string page = read_file(write_report(read_report_data(temp.path("."))));
    CHECK(has(page, "vecino run configs/a.json -o " + temp.path(".")));
    CHECK(has(page, "1 of 5 so far"));
}

TEST_CASE("the table shows means with half their intervals", "[report]") {
    std::vector<nlohmann::json> rows;
    for (int seed = 1; seed <= 4; ++seed) {
        rows.push_back(result_row("mean", seed));
        rows.back()["metrics"]["psnr_float_db"] = 20.0 + 0.1 * seed;
    }
    const auto psnr = summarise(rows).at(0).psnr_float_db.value();
    char expected[64];
    std::snprintf(expected, sizeof expected, "<b>%.2f</b><span class=\"ci\">± %.2f</span>",
                  psnr.mean, 0.5 * (*psnr.high - *psnr.low));
    CHECK(has(table_row(page_of(rows), "box.mean"), expected));
}

TEST_CASE("an interval without an upper end is shown by its lower one", "[report]") {
    std::vector<nlohmann::json> rows{result_row("mean", 1), result_row("mean", 2)};
    rows[0]["metrics"]["psnr_float_db"] = 10.0;
    rows[1]["metrics"]["psnr_float_db"] = 40.0;
    CHECK(has(table_row(page_of(rows), "box.mean"), "<span class=\"ci\">≥ "));
}

TEST_CASE("the best value of a scene is bold, in the direction of its metric", "[report]") {
    nlohmann::json path = result_row("path", 1);
    nlohmann::json mean = result_row("mean", 1);
    path["metrics"] = {{"psnr_float_db", 31.0}, {"psnr_db", 30.0}, {"ssim", 0.75}, {"relmse", 0.5}};
    mean["metrics"] = {
        {"psnr_float_db", 21.0}, {"psnr_db", 20.0}, {"ssim", 0.25}, {"relmse", 0.125}};
    mean["time_s"]["total"] = 0.25;
    const std::string page = page_of({path, mean});
    const std::string path_row = table_row(page, "box.path");
    const std::string mean_row = table_row(page, "box.mean");
    const auto has_all = [](const std::string& row, const std::vector<std::string>& parts) {
        return std::ranges::all_of(parts, [&](const std::string& part) { return has(row, part); });
    };
    CHECK(has_all(path_row, {"<b>31.00</b>", "<b>30.00</b>", "<b>0.7500</b>"}));
    CHECK(has_all(mean_row, {"<b>0.12", "<b>0.250</b>", "<b>25.00</b>"}));
    CHECK(count(path_row, "<b>") == 3);
    CHECK(count(mean_row, "<b>") == 3);
}

TEST_CASE("images equal to their reference are called identical, and are the best", "[report]") {
    nlohmann::json same = result_row("path", 1);
    same["metrics"]["psnr_float_db"] = nullptr;
    same["metrics"]["psnr_db"] = nullptr;
    const std::string page = page_of({same, result_row("mean", 1)});
    CHECK(count(table_row(page, "box.path"), "<b>identical</b>") == 2);
    CHECK(has(table_row(page, "box.mean"), ">20.00"));
}

TEST_CASE("the table has a column for a parameter only if it varies", "[report]") {
    nlohmann::json low = result_row("mean", 1);
    low["params"]["spp"] = 16;
    low["params"]["max_depth"] = 2;
    nlohmann::json high = low;
    high["cell"] = "box.mean.spp64.s1";
    high["group"] = "box.mean.spp64";
    high["params"]["spp"] = 64;
    const std::string page = page_of({low, high});
    CHECK(has(table_head(page), ">spp<"));
    CHECK_FALSE(has(table_head(page), ">max_depth<"));
    CHECK(has(table_row(page, "box.mean.spp64"), "data-value=\"64."));
    CHECK(has(page, "max_depth 2"));
}

TEST_CASE("groups keep the order of the run, not that of their names", "[report]") {
    const std::string page =
        page_of({result_row("path", 1), result_row("nearest", 1), result_row("mean", 1)});
    const auto at = [&](const std::string& group) { return page.find("data-words=\"" + group); };
    CHECK(at("box.path") < at("box.nearest"));
    CHECK(at("box.nearest") < at("box.mean"));
}

TEST_CASE("bytes become base64 with the padding of RFC 4648", "[html_text]") {
    const std::string prefix = "data:image/png;base64,";
    CHECK(png_url("") == prefix);
    CHECK(png_url("f") == prefix + "Zg==");
    CHECK(png_url("fo") == prefix + "Zm8=");
    CHECK(png_url("foobar") == prefix + "Zm9vYmFy");
    CHECK(png_url("\xff\xfe\xfb") == prefix + "//77");
}

TEST_CASE("JSON in a script keeps its values and cannot end the script", "[html_text]") {
    const nlohmann::json json = {{"a<b", "</script><!--"}, {"broken", "\xff"}};
    const std::string text = script_json(json);
    CHECK_FALSE(has(text, "<"));
    CHECK(nlohmann::json::parse(text)["a<b"] == "</script><!--");
}

TEST_CASE("a page is filled once: what is put in is not searched", "[html_text]") {
    CHECK(fill_page("{{a}}-{{b}}{{a}}", {{"a", "{{b}}"}, {"b", "x"}}) == "{{b}}-x{{b}}");
    CHECK(fill_page("no names", {}) == "no names");
    CHECK_THROWS_AS(fill_page("{{missing}}", {}), std::logic_error);
}
