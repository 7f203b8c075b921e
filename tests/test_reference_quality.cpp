// SPDX-License-Identifier: Apache-2.0
//
// A reference's own error, from the difference of its two halves.
#include <cmath>
#include <string>

#include "eval/metrics.h"
#include "eval/reference_quality.h"
#include "eval/report_data.h"
#include "tests/catch.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

RenderSettings reference_of(const TinyMatrix& run, const std::string& cell) {
    const Matrix matrix = run.load();
    for (const Cell& each : expand(matrix))
        if (each.name == cell) return reference_settings(matrix, each);
    throw std::runtime_error("no such cell");
}

double psnr(const Image& test, const Image& reference) {
    return compare(test, reference).metrics.value().psnr_float_db.value();
}

}  // namespace

TEST_CASE("a reference is the mean of two halves, weighted by their samples", "[references]") {
    TinyMatrix run;
    run.json["reference"]["spp"] = GENERATE(128, 3);
    CHECK(run.run().failed == 0);
    const Json row = run.rows().at("box.path.s1");
    const RenderSettings whole = reference_of(run, "box.path.s1");
    const Scene scene = load_scene(run.temp.path("box.json"));
    RenderSettings half = whole;
    half.planes = reference_planes();
    half.spp = (whole.spp + 1) / 2;
    const Frame first = render(scene, half).frame;
    half.spp = whole.spp / 2;
    half.seed = whole.seed + 1;
    const Frame second = render(scene, half).frame;
    const double weight = double(half.spp) / whole.spp;
    const Frame made = run.reference(row);
    const auto is_mean = [&](const Image& mean, const Image& a, const Image& b) {
        for (std::size_t i = 0; i < mean.values().size(); ++i)
            for (int c = 0; c < 3; ++c)
                CHECK(mean.values()[i][c] == Approx((1 - weight) * double(a.values()[i][c]) +
                                                    weight * double(b.values()[i][c]))
                                                 .margin(1e-6));
    };
    is_mean(made.radiance, first.radiance, second.radiance);
    is_mean(made.direct, first.direct, second.direct);
    is_mean(made.indirect, first.indirect, second.indirect);
    const double expected =
        psnr(first.radiance, second.radiance) - 10 * std::log10(weight * (1 - weight));
    CHECK(row["reference_error"]["psnr_float_db"].get<double>() == Approx(expected));
}

TEST_CASE("a reference's own error is what a far better one finds", "[references]") {
    TinyMatrix run;
    run.json["fixed"]["size"] = {48, 48};
    run.json["reference"] = {{"spp", 64}, {"sampler", "independent"}, {"seed", 1000}};
    CHECK(run.run().failed == 0);
    const Json row = run.rows().at("box.path.s1");
    RenderSettings better = reference_of(run, "box.path.s1");
    better.spp = 4096;
    better.seed = 7;
    better.sampler = Sampler::sobol;
    better.planes = {};
    const Image truth = render(load_scene(run.temp.path("box.json")), better).frame.radiance;
    const double estimated = row["reference_error"]["psnr_float_db"];
    CHECK(estimated == Approx(psnr(run.reference(row).radiance, truth)).margin(0.5));
}

TEST_CASE("a reference of one sample says nothing of its error", "[references]") {
    TinyMatrix run;
    run.json["reference"]["spp"] = 1;
    CHECK(run.run().failed == 0);
    CHECK(run.rows().at("box.path.s1")["reference_error"].is_null());
    const auto references = reference_quality(read_report_data(run.directory));
    REQUIRE(references.size() == 1);
    CHECK_FALSE(references[0].parts[0].own_db);
    CHECK_FALSE(references[0].parts[0].margin_db());
}

TEST_CASE("results within 15 dB of their reference's own error are named", "[references]") {
    TinyMatrix run;
    CHECK(run.run().failed == 0);
    auto rows = run.rows();
    const auto set = [&](double own_db) {
        for (auto& [name, row] : rows) {
            row["reference_error"] = {{"psnr_float_db", own_db}};
            row["metrics"]["psnr_float_db"] = row["group"] == "box.path" ? 40.0 : 20.0;
        }
        run.write_rows(rows);
        return reference_quality(read_report_data(run.directory)).at(0).parts.at(0);
    };
    const ReferencePart good = set(55.5);
    CHECK(good.best == "box.path");
    CHECK(good.margin_db().value() == Approx(15.5));
    CHECK(good.too_close.empty());
    CHECK(set(54.5).too_close == std::vector<std::string>{"box.path"});
    CHECK(set(30).too_close.size() > 1);
}

TEST_CASE("a run says what it took, over all its goes", "[references]") {
    const TinyMatrix run;
    run.run();
    const auto spent = [&] { return Json::parse(run.temp.read("run/run.json")); };
    const Json first = spent();
    // Two seeds of path tracing and of a quarter of the pixels at 8 spp, and the reference.
    CHECK(first["samples"] == 2 * 16 * 12 * 8 + 2 * 8 * 6 * 8 + 16 * 12 * 128);
    CHECK(first["seconds"].get<double>() > 0);
    run.run();
    CHECK(spent()["samples"] == first["samples"]);
    CHECK(spent()["seconds"].get<double>() > first["seconds"].get<double>());
}
