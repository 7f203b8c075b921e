// SPDX-License-Identifier: Apache-2.0
//
// The report's section on convergence, from a run of a small matrix.
#include <string>

#include "core/files.h"
#include "eval/report.h"
#include "eval/report_data.h"
#include "tests/catch.h"
#include "tests/page_text.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

/// Path tracing of the Cornell box by chance and by next-event estimation at three spp.
struct LadderMatrix : TinyMatrix {
    LadderMatrix() {
        json["axes"] = {{"scene", "box.json"},
                        {"method", "path"},
                        {"light_sampling", {"none", "nee"}},
                        {"spp", {4, 16, 64}},
                        {"seed", {1, 2}}};
        json["fixed"] = {{"size", {16, 12}}, {"sampler", "independent"}};
    }
};

std::string page_of(const TinyMatrix& matrix) {
    return read_file(write_report(read_report_data(matrix.directory)));
}

}  // namespace

TEST_CASE("a report of path tracing at several spp shows how it converges", "[report]") {
    const LadderMatrix matrix;
    matrix.run();
    const std::string page = page_of(matrix);
    CHECK(has(page, "<a href=\"#convergence\">"));
    const std::string section = between(page, "<section id=\"convergence\">", "</section>");
    CHECK(count(section, "<canvas") == 2);  // against samples and against time
    CHECK(has(section, "data-convergence=\"box\" data-against=\"spp\""));
    CHECK(has(section, "baseline"));
    const std::string row = between(section, "data-scene=\"box\">", "</tr>");
    CHECK(has(row, "#g"));
    const nlohmann::json data = embedded_data(page)["convergence"];
    REQUIRE(data.size() == 2);
    CHECK(data[0]["variant"] == "none");
    CHECK(data[0]["baseline"] == true);
    CHECK(data[1]["variant"] == "nee");
    REQUIRE(data[1]["points"].size() == 3);
    CHECK(data[1]["points"][2]["spp"] == 64);
    CHECK(data[1]["points"][2]["relmse"]["mean"].get<double>() > 0);
    CHECK(data[1]["points"][2]["variance"].get<double>() > 0);
    CHECK(data[1]["points"][2]["trace_s"].get<double>() > 0);
    // Independent samples: the error falls as 1 / spp.
    CHECK(data[1]["error_by_spp"]["slope"].get<double>() == Approx(-1).margin(0.3));
    CHECK(data[1]["variance_by_spp"]["slope"].get<double>() == Approx(-1).margin(0.3));
    CHECK(data[1]["speed_up"]["factor"].get<double>() > 1);
}

TEST_CASE("a report of one spp has no section on convergence", "[report]") {
    const TinyMatrix matrix;
    matrix.run();
    const std::string page = page_of(matrix);
    CHECK_FALSE(has(page, "id=\"convergence\""));
    CHECK_FALSE(has(page, "#convergence"));
    CHECK(embedded_data(page)["convergence"].empty());
}
