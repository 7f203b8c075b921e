// SPDX-License-Identifier: Apache-2.0
//
// All ways of sampling agree in expectation with images of an independent renderer
// (tests/data/README.md): no way is right that is off by more than its own noise says.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/image_io.h"
#include "eval/render_options.h"
#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

/// One way of sampling: values of options of vecino render, and the samples that one seed gets.
struct Variant {
    std::vector<std::pair<const char*, const char*>> options;
    int spp;
};

// clang-format off
const std::vector<Variant>& variants() {
    static const std::vector<Variant> rows = {
        {{{"light_sampling", "none"}, {"sampler", "independent"}}, 2048},
        {{{"light_sampling", "none"}, {"sampler", "sobol"}}, 2048},
        {{{"light_point", "area"}, {"control_variate", "none"}, {"multiple_importance", "none"}, {"sampler", "independent"}}, 256},
        {{{"light_point", "area"}, {"control_variate", "none"}, {"multiple_importance", "none"}, {"sampler", "sobol"}}, 256},
        {{{"light_point", "area"}, {"control_variate", "none"}, {"multiple_importance", "balance"}, {"sampler", "independent"}}, 256},
        {{{"light_point", "area"}, {"control_variate", "none"}, {"multiple_importance", "balance"}, {"sampler", "sobol"}}, 256},
        {{{"light_point", "area"}, {"control_variate", "irradiance"}, {"sampler", "independent"}}, 256},
        {{{"light_point", "area"}, {"control_variate", "irradiance"}, {"sampler", "sobol"}}, 256},
        {{{"light_point", "solid_angle"}, {"control_variate", "none"}, {"sampler", "independent"}}, 256},
        {{{"light_point", "solid_angle"}, {"control_variate", "none"}, {"sampler", "sobol"}}, 256},
        {{{"light_point", "solid_angle"}, {"control_variate", "irradiance"}, {"sampler", "independent"}}, 256},
        {{{"light_point", "solid_angle"}, {"control_variate", "irradiance"}, {"sampler", "sobol"}}, 256},
    };
    return rows;
}
// clang-format on

constexpr int kSide = 16;  ///< pixels of a render; one is a block of the reference
constexpr int kSeeds = 16;

RenderSettings settings_of(const Variant& variant) {
    RenderSettings settings = small_settings({kSide, kSide}, variant.spp);
    settings.planes = {Plane::radiance};
    for (const auto& [name, value] : variant.options) {
        const auto rows = render_options();
        const auto row = std::ranges::find(rows, name, &RenderOption::name);
        REQUIRE(row != rows.end());
        const nlohmann::json json = value;
        row->set(settings, JsonValue(json, name));
    }
    return settings;
}

std::string name_of(const Variant& variant) {
    std::string name;
    for (const auto& option : variant.options) name += std::string(option.second) + " ";
    return name;
}

/// Mean and variance of the mean, by pixel and channel.
struct Measured {
    std::vector<glm::dvec3> mean, variance;
    glm::dvec3 mean_variance{0.0};  ///< of the mean over all pixels
};

Measured measure(const std::vector<Image>& images) {
    const std::size_t pixels = images[0].values().size();
    const auto n = static_cast<double>(images.size());
    Measured result{std::vector(pixels, glm::dvec3(0.0)), std::vector(pixels, glm::dvec3(0.0)), {}};
    glm::dvec3 whole(0.0);
    glm::dvec3 whole_squares(0.0);
    for (const Image& image : images) {
        for (std::size_t i = 0; i < pixels; ++i) {
            const glm::dvec3 value = image.values()[i];
            result.mean[i] += value / n;
            result.variance[i] += value * value;
        }
        whole += mean_of(image) / n;
        whole_squares += mean_of(image) * mean_of(image);
    }
    for (std::size_t i = 0; i < pixels; ++i) {
        const glm::dvec3 spread = result.variance[i] - n * result.mean[i] * result.mean[i];
        result.variance[i] = glm::max(spread, glm::dvec3(0.0)) / (n - 1) / n;
    }
    result.mean_variance =
        glm::max(whole_squares - n * whole * whole, glm::dvec3(0.0)) / (n - 1) / n;
    return result;
}

Measured measure(const Scene& scene, const Variant& variant) {
    RenderSettings settings = settings_of(variant);
    std::vector<Image> images;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        settings.seed = static_cast<std::uint32_t>(seed);
        images.push_back(render(scene, settings).frame.radiance);
    }
    return measure(images);
}

/// What is held against: means over blocks, and the variance of these.
struct Expected {
    std::vector<glm::dvec3> mean, variance;
};

/// The other renderer took independent samples with next-event estimation: the variance of its
/// blocks is that of such samples here, over as many as went into a block. It also weighs in the
/// light that it finds by chance, which makes it less noisy, if anything.
Expected reference_of(const std::string& name, const Scene& scene, int reference_spp) {
    const Image image =
        load_image(std::string(VECINO_SOURCE_DIR) + "/tests/data/" + name + "_depth2_128.exr");
    const int side = image.size().width / kSide;
    Expected expected{std::vector(kSide * kSide, glm::dvec3(0.0)), {}};
    for (int y = 0; y < image.size().height; ++y) {
        for (int x = 0; x < image.size().width; ++x) {
            const auto block = static_cast<std::size_t>(y / side * kSide + x / side);
            expected.mean[block] += glm::dvec3(image(x, y)) / static_cast<double>(side * side);
        }
    }
    const Variant& like = variants()[2];
    const double share = like.spp * kSeeds / (static_cast<double>(reference_spp) * side * side);
    for (const glm::dvec3& variance : measure(scene, like).variance)
        expected.variance.push_back(share * variance);
    return expected;
}

struct Agreement {
    double chi2 = 0;        ///< mean of squared deviations in standard errors
    double worst = 0;       ///< largest deviation of a block, in standard errors
    double worst_mean = 0;  ///< deviation of the mean over the image, likewise
};

/// Renderers differ in rounding and in how far rays start off a surface: 2e-4 of a value is no
/// disagreement.
constexpr double kSlack = 2e-4;

Agreement agreement(const Measured& measured, const Expected& expected) {
    Agreement result;
    const auto count = static_cast<double>(expected.mean.size());
    for (int c = 0; c < 3; ++c) {
        double sum = 0;
        double variance = measured.mean_variance[c];
        double level = 0;
        for (std::size_t i = 0; i < expected.mean.size(); ++i) {
            const double off = measured.mean[i][c] - expected.mean[i][c];
            const double slack = kSlack * expected.mean[i][c] + 1e-7;
            const double square =
                off * off / (measured.variance[i][c] + expected.variance[i][c] + slack * slack);
            result.chi2 += square / (3 * count);
            result.worst = std::max(result.worst, std::sqrt(square));
            sum += off / count;
            variance += expected.variance[i][c] / (count * count);
            level += expected.mean[i][c] / count;
        }
        const double slack = kSlack * level;
        result.worst_mean =
            std::max(result.worst_mean, std::abs(sum) / std::sqrt(variance + slack * slack));
    }
    return result;
}

// Squares of Student's t with 15 degrees of freedom have the mean 15/13 and the standard deviation
// 1.84; channels of a block go together, so that 256 blocks make it 0.115. The limits are 4.5 of
// these above the mean, and 1e-5 likely for one t of the worst block (of 768) and of the mean.
constexpr double kMostChi2 = 15.0 / 13.0 + 4.5 * 0.115;
constexpr double kMostWorst = 9.0;
constexpr double kMostMean = 5.5;

bool agrees(const Agreement& a) {
    return a.chi2 < kMostChi2 && a.worst < kMostWorst && a.worst_mean < kMostMean;
}

/// A floor and two walls with a lamp of every kind, near them and far: a rectangle, a skew
/// parallelogram, a quad that is none, two triangles, a sphere and a lamp that faces away; a sky
/// too.
Scene lamps_of_every_kind() {
    return scene_from(R"({
        "camera": {"position": [0, 1.2, 4.2], "look_at": [0, 0.7, 0], "up": [0, 1, 0], "vertical_fov_degrees": 35},
        "background": [0.05, 0.06, 0.08],
        "materials": {"white": {"albedo": [0.7, 0.7, 0.7]}, "red": {"albedo": [0.6, 0.2, 0.2]},
                      "weak": {"emission": [0.5, 0.6, 0.7]}, "strong": {"emission": [4, 3, 2]},
                      "warm": {"albedo": [0.5, 0.5, 0.5], "emission": [1.5, 1, 0.5]}},
        "objects": [
          {"quad": [[-2, 0, 2], [2, 0, 2], [2, 0, -1], [-2, 0, -1]], "material": "white"},
          {"quad": [[-2, 0, -1], [2, 0, -1], [2, 2, -1], [-2, 2, -1]], "material": "white"},
          {"quad": [[-2, 0, 2], [-2, 0, -1], [-2, 2, -1], [-2, 2, 2]], "material": "red"},
          {"quad": [[-1.5, 1.8, -0.9], [-0.9, 1.8, -0.9], [-0.9, 1.8, -0.4], [-1.5, 1.8, -0.4]], "material": "strong"},
          {"quad": [[-0.6, 0.3, -0.8], [-0.1, 0.3, -0.8], [0.1, 0.3, -0.4], [-0.4, 0.3, -0.4]], "material": "weak"},
          {"quad": [[0.6, 0.9, -0.95], [1.2, 0.9, -0.95], [1.1, 0.9, -0.5], [0.7, 0.9, -0.4]], "material": "warm"},
          {"triangles": {"positions": [[-1.95, 0.4, 0], [-1.95, 0.4, 0.8], [-1.6, 0.9, 0.4], [-1.95, 1.4, 0.4]],
                         "indices": [[0, 1, 2], [1, 3, 2]]}, "material": "weak"},
          {"sphere": {"center": [1.5, 0.3, 0.2], "radius": 0.15}, "material": "strong"},
          {"quad": [[0, 1.9, 0], [0.4, 1.9, 0], [0.4, 1.9, -0.4], [0, 1.9, -0.4]], "material": "strong"}]})");
}

/// Ways of choosing among emitters and of weighing in what bounces find.
std::vector<Variant> choices() {
    std::vector<Variant> rows = {{{{"light_sampling", "none"}}, 4096}};
    for (const char* choice : {"power", "contribution"})
        for (const char* importance : {"none", "balance"})
            for (const char* sampler : {"independent", "sobol"})
                rows.push_back({{{"light_choice", choice},
                                 {"multiple_importance", importance},
                                 {"sampler", sampler}},
                                256});
    return rows;
}

Measured scaled(Measured measured, double factor) {
    for (glm::dvec3& value : measured.mean) value *= factor;
    return measured;
}

/// The variant agrees, and the test can tell: the same image brighter by 3 % (of light found by
/// chance: 10 %) does not.
void check_agrees(const Scene& scene, const Variant& variant, const Expected& expected) {
    const Measured measured = measure(scene, variant);
    const Agreement found = agreement(measured, expected);
    CAPTURE(name_of(variant), found.chi2, found.worst, found.worst_mean);
    CHECK(agrees(found));
    const bool by_chance = std::string_view(variant.options[0].second) == "none";
    CHECK_FALSE(agrees(agreement(scaled(measured, by_chance ? 1.1 : 1.03), expected)));
}

}  // namespace

TEST_CASE("every way of sampling agrees in expectation with an independent renderer",
          "[render][slow]") {
    const auto [name, reference_spp] =
        GENERATE(table<std::string, int>({{"cornell", 32768},
                                          {"cornell_sphere", 32768},
                                          {"hard_shadows", 8192},
                                          {"checker_spheres", 8192}}));
    const Scene scene = repository_scene(name);
    const Expected expected = reference_of(name, scene, reference_spp);
    CAPTURE(name);
    for (const Variant& variant : variants()) check_agrees(scene, variant, expected);
}

// Close to a lamp, where points by area are noisiest: there is no other renderer's image, but a
// lamp of two triangles is sampled by area alone, without anything that is known of rectangles.
TEST_CASE("near a lamp, every way of sampling a rectangle agrees with two triangles by area",
          "[render][slow]") {
    Variant by_area = variants()[2];
    by_area.spp = 4096;
    const Measured triangles = measure(repository_scene("near_lamp_mesh"), by_area);
    const Expected expected{triangles.mean, triangles.variance};
    const Scene rectangle = repository_scene("near_lamp");
    for (const Variant& variant : variants()) check_agrees(rectangle, variant, expected);
    const Scene mesh = repository_scene("near_lamp_mesh");
    for (const char* sampler : {"independent", "sobol"})
        check_agrees(mesh, {{{"multiple_importance", "balance"}, {"sampler", sampler}}, 1024},
                     expected);
}

// The way that knows least of where emitters are is held against: by power, points by area, each
// light found in one way alone.
TEST_CASE("of many emitters, every way of choosing one agrees with chance and with power",
          "[render][slow]") {
    const bool is_corridor = GENERATE(false, true);
    const Scene scene = is_corridor ? repository_scene("corridor") : lamps_of_every_kind();
    const Variant plain{{{"light_choice", "power"},
                         {"light_point", "area"},
                         {"control_variate", "none"},
                         {"multiple_importance", "none"},
                         {"sampler", "independent"}},
                        8192};
    const Measured by_power = measure(scene, plain);
    const Expected expected{by_power.mean, by_power.variance};
    CAPTURE(is_corridor);
    for (const Variant& variant : choices()) check_agrees(scene, variant, expected);
}
