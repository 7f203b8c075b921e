// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "eval/gate_metrics.h"
#include "eval/metrics_json.h"
#include "eval/pixel_values.h"
#include "tests/catch.h"

using namespace vecino;
using nlohmann::json;

namespace {

const MetricInfo& info_of(const std::string& name) {
    return *find_gate_metric(name).value().info;
}

Image constant(Extent size, float value) {
    Image image(size);
    for (glm::vec3& pixel : image.values()) pixel = glm::vec3(value);
    return image;
}

}  // namespace

TEST_CASE("an error turns into a value and back, for every metric", "[gate]") {
    for (const GateMetric& metric : all_gate_metrics()) {
        CAPTURE(metric.name);
        for (const double error : {0.9, 0.01, 1e-4})
            CHECK(error_of_value(*metric.info, value_of_error(*metric.info, error)) ==
                  Approx(error).epsilon(1e-9));
        const bool grows = value_of_error(*metric.info, 0.2) > value_of_error(*metric.info, 0.1);
        CHECK(grows != metric.info->higher_is_better);
    }
}

TEST_CASE("errors are averaged, and the mean is turned back", "[gate]") {
    // 20 and 30 dB: errors of 0.01 and 0.001, 0.0055 on average.
    const MetricSpread db = spread_over_seeds(info_of("psnr_float_db"), {0.01, 0.001});
    CHECK(db.mean == Approx(-10 * std::log10(0.0055)));
    const MetricSpread plain = spread_over_seeds(info_of("p99_error"), {0.1, 0.3});
    CHECK(plain.mean == Approx(0.2));
    CHECK(plain.deviation == Approx(std::sqrt(0.02)));
    CHECK(relative_deviation(info_of("p99_error"), plain) == Approx(std::sqrt(0.5)));
    CHECK(relative_deviation(info_of("psnr_float_db"), db) ==
          Approx(0.0045 * std::sqrt(2.0) / 0.0055));
    CHECK(spread_over_seeds(info_of("ssim"), {0.1}).deviation == 0);
}

TEST_CASE("a metric is read from the whole image or from a region", "[gate]") {
    const json metrics = {{"psnr_float_db", 20.0},
                          {"ssim", nullptr},
                          {"regions",
                           {{"edge", {{"pixels", 4}, {"psnr_float_db", 10.0}}},
                            {"emitter", {{"pixels", 0}, {"psnr_float_db", nullptr}}},
                            {"interior", {{"pixels", 4}, {"psnr_float_db", nullptr}}}}}};
    const auto error = [&](const char* name) {
        return error_in(find_gate_metric(name).value(), metrics);
    };
    CHECK(error("psnr_float_db").value() == Approx(0.01));
    CHECK(error("edge.psnr_float_db").value() == Approx(0.1));
    CHECK(error("interior.psnr_float_db").value() == Approx(1e-10));  // identical: 100 dB
    CHECK_FALSE(error("emitter.psnr_float_db"));
    CHECK_FALSE(error("ssim"));
    CHECK_FALSE(error("p99_error"));
    CHECK_FALSE(find_gate_metric("edge.nonsense"));
    CHECK_FALSE(find_gate_metric("edge.worst_tile_psnr_db"));
}

TEST_CASE("the worst tile is found wherever it is, also at a clipped border", "[metrics]") {
    const Extent size{40, 23};  // tiles at 0, 16, 24 and 0, 7
    const Image reference = constant(size, 0.5f);
    const int x = GENERATE(0, 15, 16, 30, 39);
    const int y = GENERATE(0, 8, 22);
    CAPTURE(x, y);
    Image test = reference;
    test(x, y) = glm::vec3(1.0f);
    const double step = 1.0 - static_cast<double>(display_value(glm::vec3(0.5f)).x);
    const Metrics metrics = compare(test, reference).metrics.value();
    CHECK(metrics.worst_tile_psnr_db.value() ==
          Approx(-10 * std::log10(step * step / 256)).epsilon(1e-5));
    CHECK(metrics.psnr_float_db.value() ==
          Approx(-10 * std::log10(step * step / (40 * 23))).epsilon(1e-5));
}

TEST_CASE("of an image smaller than a tile, the worst tile is the image", "[metrics]") {
    const Image reference = constant({7, 3}, 0.5f);
    Image test = reference;
    test(6, 2) = glm::vec3(0.0f);
    const Metrics metrics = compare(test, reference).metrics.value();
    CHECK(metrics.worst_tile_psnr_db.value() == Approx(metrics.psnr_float_db.value()));
    CHECK_FALSE(compare(reference, reference).metrics->worst_tile_psnr_db);
}
