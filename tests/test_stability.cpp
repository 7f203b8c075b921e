// SPDX-License-Identifier: Apache-2.0
//
// Moved cameras, shimmer and elasticity against values that are known.
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/color.h"
#include "eval/perturbation.h"
#include "eval/render_options.h"
#include "eval/stability.h"
#include "eval/stability_summary.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/scene_text.h"
#include "tests/scheme_frames.h"
#include "tests/temp_dir.h"

using namespace vecino;
using namespace vecino::test;
using nlohmann::json;

namespace {

Frame seen(const Scene& scene, glm::vec2 shift, int reduction = 1) {
    RenderSettings settings = small_settings({40, 30}, 4);
    settings.first_hit = FirstHit::centre;
    settings.reduction = reduction;
    settings.camera_shift = shift;
    return render(scene, settings).frame;
}

/// Whether b shows what a shows, dx and dy pixels further.
bool is_moved(const Frame& a, const Frame& b, int dx, int dy) {
    const Extent size = a.object_id.size();
    for (int y = std::max(0, -dy); y < std::min(size.height, size.height - dy); ++y) {
        for (int x = std::max(0, -dx); x < std::min(size.width, size.width - dx); ++x) {
            const glm::vec3 d = b.position_world(x, y) - a.position_world(x + dx, y + dy);
            if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) > 1e-5f) return false;
        }
    }
    return true;
}

Image noisy(const Image& image, float size, unsigned seed) {
    Random random(seed);
    Image result = image;
    for (glm::vec3& value : result.values()) value += size * (random.vector() - 0.5f);
    return result;
}

/// Grey values in the middle of the display range: nothing is clipped.
Image grey_pattern(float phase) {
    Image image({64, 48});
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            image(x, y) = glm::vec3(0.4f + 0.1f * std::sin(0.5f * static_cast<float>(x) + phase));
    return image;
}

Cell scheme_cell(const char* name) {
    Cell cell;
    cell.kind = CellKind::scheme;
    cell.scheme = &find_scheme(name);
    return cell;
}

const Perturbation* find(const std::vector<Perturbation>& all, std::string_view parameter) {
    const auto found = std::ranges::find(all, parameter, &Perturbation::parameter);
    return found == all.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("a camera that moves by whole pixels shows the same pixels elsewhere", "[stability]") {
    const Scene scene = repository_scene("cornell_sphere");
    const Frame still = seen(scene, {0, 0});
    CHECK(is_moved(still, seen(scene, {1, 0}), 1, 0));
    CHECK(is_moved(still, seen(scene, {0, 1}), 0, 1));
    CHECK(is_moved(still, seen(scene, {-3, 5}), -3, 5));
    CHECK_FALSE(is_moved(still, seen(scene, {0.5f, 0}), 0, 0));
    // The shift is of full-resolution pixels.
    CHECK(is_moved(seen(scene, {0, 0}, 2), seen(scene, {2, -4}, 2), 1, -2));
}

TEST_CASE("a camera that is not moved has the bits that it had", "[stability]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({16, 16}, 4);
    const Image plain = render(scene, settings).frame.radiance;
    settings.camera_shift = {0.25f, 0.25f};
    CHECK_FALSE(render(scene, settings).frame.radiance == plain);
    settings.camera_shift = {-0.0f, 0.0f};
    CHECK(render(scene, settings).frame.radiance == plain);
    settings.camera_shift = {std::nanf(""), 0.0f};
    CHECK(error_of([&] { render(scene, settings); }).code() == ExitCode::usage);
}

TEST_CASE("shimmer is 1 for what changes as the reference does, with noise and without",
          "[stability]") {
    const Image still = grey_pattern(0.0f);
    const Image moved = grey_pattern(0.2f);
    const double change = display_mse(moved, still);
    const std::vector<Image> one{still}, one_moved{moved};
    const auto exact = shimmer(one, one_moved, 0.25, change).value();
    CHECK(exact.with_noise == Approx(1));
    CHECK_FALSE(exact.without_noise);  // one seed cannot tell

    std::vector<Image> images, shifted;
    for (unsigned seed = 0; seed < 8; ++seed) {
        images.push_back(noisy(still, 0.2f, 2 * seed));
        shifted.push_back(noisy(moved, 0.2f, 2 * seed + 1));
    }
    const auto result = shimmer(images, shifted, 0.25, change).value();
    CHECK(result.with_noise > 2);
    CHECK(*result.without_noise == Approx(1).margin(0.1));
    // The same noise at both places is no change.
    for (unsigned seed = 0; seed < 8; ++seed) shifted[seed] = images[seed];
    CHECK(shimmer(images, shifted, 0.25, change)->with_noise == 0);
    CHECK_FALSE(shimmer(images, shifted, 0.25, 0.0));
}

TEST_CASE("twice the change is a shimmer of 4", "[stability]") {
    const Image still({8, 8}, glm::vec3(0.3f));
    Image once = still, twice = still;
    // Equal steps of display values.
    const auto encoded = [](float linear, float step) {
        return srgb_decode(srgb_encode(linear) + step);
    };
    for (int i = 0; i < 8; ++i) {
        once(i, 3) = glm::vec3(encoded(0.3f, 0.05f));
        twice(i, 3) = glm::vec3(encoded(0.3f, 0.1f));
    }
    const std::vector<Image> images{still, still}, shifted{twice, twice};
    const auto result = shimmer(images, shifted, 0.5, display_mse(once, still)).value();
    CHECK(result.with_noise == Approx(4).epsilon(1e-4));
    CHECK(*result.without_noise == Approx(4).epsilon(1e-4));
}

TEST_CASE("path tracing shimmers as the scene does, blocks of pixels do not", "[stability]") {
    const Scene scene = repository_scene("cornell_sphere");
    const auto images = [&](int spp, glm::vec2 shift, int reduction, std::uint32_t seed) {
        RenderSettings settings = small_settings({48, 48}, spp);
        settings.reduction = reduction;
        settings.camera_shift = shift;
        settings.seed = seed;
        settings.planes = {Plane::radiance};
        return render(scene, settings).frame;
    };
    const Image reference = images(1024, {0, 0}, 1, 1000).radiance;
    const Image moved_reference = images(1024, {0.5f, 0.5f}, 1, 1000).radiance;
    const double change = display_mse(moved_reference, reference);
    std::vector<Image> paths, moved_paths, blocks, moved_blocks;
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
        paths.push_back(images(64, {0, 0}, 1, seed).radiance);
        moved_paths.push_back(images(64, {0.5f, 0.5f}, 1, seed).radiance);
        const Scheme& nearest = find_scheme("nearest");
        blocks.push_back(rebuild(images(64, {0, 0}, 4, seed), nearest, {}, {48, 48}).image);
        moved_blocks.push_back(
            rebuild(images(64, {0.5f, 0.5f}, 4, seed), nearest, {}, {48, 48}).image);
    }
    const auto path = shimmer(paths, moved_paths, 0.5, change).value();
    CHECK(*path.without_noise == Approx(1).margin(0.15));
    CHECK(path.with_noise > *path.without_noise);
    // A block takes in 16 pixels: an edge that moves half a pixel changes all of them by an eighth.
    CHECK(*shimmer(blocks, moved_blocks, 0.5, change)->without_noise < 0.6);
}

TEST_CASE("parameters are varied by about half, on the scale that they are read on",
          "[stability]") {
    Cell cell = scheme_cell("distance3d_normal");
    const auto windows = [&](int window) {
        cell.parameters.window = window;
        const std::vector<Perturbation> all = perturbations(cell);
        const Perturbation& both = *find(all, "window");
        CHECK(both.low.value == both.low.cell.parameters.window);
        return std::pair(both.low.cell.parameters.window, both.high.cell.parameters.window);
    };
    CHECK(windows(1) == std::pair(1, 3));
    CHECK(windows(3) == std::pair(1, 5));
    CHECK(windows(5) == std::pair(3, 7));
    CHECK(windows(7) == std::pair(3, 11));
    CHECK(windows(21) == std::pair(11, 31));
    const std::vector<Perturbation> all = perturbations(cell);
    const Perturbation& cosine = *find(all, "min_normal_cosine");
    CHECK(cosine.low.value == Approx(9.097).margin(1e-3));
    CHECK(cosine.high.value == Approx(27.292).margin(1e-3));
    CHECK(cosine.low.cell.parameters.min_normal_cosine == Approx(0.98742f));
    CHECK(cosine.low.cell.parameters.window == 21);
    cell.parameters.min_normal_cosine = 1.0f;
    CHECK(find(perturbations(cell), "min_normal_cosine") == nullptr);
    CHECK(perturbations(Cell{}).empty());
}

TEST_CASE("every numeric option of a scheme or a method is varied", "[stability]") {
    const auto is_number = [](const json& schema) {
        const std::string type = schema.value("type", "");
        return type == "number" || type == "integer";
    };
    for (const Scheme& scheme : all_schemes()) {
        const std::vector<Perturbation> all = perturbations(scheme_cell(scheme.name.data()));
        for (const std::string_view option : scheme.options) {
            INFO(scheme.name << ": " << option);
            const bool is_varied = find(all, option) != nullptr;
            CHECK(is_varied == is_number(find_scheme_option(option).schema()));
        }
    }
    for (const Method& method : all_methods()) {
        Cell cell;
        cell.kind = CellKind::method;
        cell.render_method = &method;
        const std::vector<Perturbation> all = perturbations(cell);
        for (const MethodOption& row : method_options()) {
            const json value = row.get(MethodParameters{});
            const bool is_set = value.is_number() && value != 0;
            if (!method.reads(row.name) || !is_number(row.schema()) || !is_set) continue;
            INFO(method.name << ": " << row.name);
            CHECK(find(all, row.name) != nullptr);
        }
    }
}

TEST_CASE("options of tables are scaled within their range", "[stability]") {
    const auto rows = render_options();
    const auto row = [&](std::string_view name) {
        return *std::ranges::find(rows, name, &RenderOption::name);
    };
    RenderSettings settings;
    settings.spp = 64;
    CHECK(scale_option(row("spp"), settings, 1.5) == 96.0);
    CHECK(settings.spp == 96);
    settings.spp = 1;
    CHECK(scale_option(row("spp"), settings, 1.5) == 2.0);  // one more at least
    settings.spp = 1;
    CHECK(scale_option(row("spp"), settings, 0.5) == 1.0);  // 0 is not allowed
    settings.max_depth = 900;
    CHECK(scale_option(row("max_depth"), settings, 1.5) == 900.0);
    settings.max_depth = 0;
    CHECK_FALSE(scale_option(row("max_depth"), settings, 1.5));
    CHECK_FALSE(scale_option(row("sampler"), settings, 1.5));
}

TEST_CASE("a group's stability is that of its rows", "[stability]") {
    const TempDir temp;
    const RunDirectory directory = RunDirectory::create(temp.path("run"));
    const auto row = [](const char* cell, double psnr, double low, double high, int fallback) {
        return json{
            {"cell", cell},
            {"group", "g"},
            {"status", "ok"},
            {"params", {{"size", {20, 10}}, {"reduction", 2}}},
            {"metrics", {{"psnr_float_db", psnr}}},
            {"reference_error", {{"psnr_float_db", 40.0}}},
            {"counts",
             {{"fallback_pixels", fallback}, {"dropped_samples", 3}, {"non_finite_pixels", 0}}},
            {"stability",
             {{"shimmer", {{{"shift", 0.25}, {"change", 0.02}, {"reference_change", 0.01}}}},
              {"elasticity",
               {{"window",
                 {{"low", {{"value", 3}, {"mse", low}}},
                  {"high", {{"value", 6}, {"mse", high}}}}}}}}}};
    };
    std::vector<json> rows{row("a", 30, 0.01, 0.04, 5), row("b", 33, 0.01, 0.01, 10)};
    const GroupStability s = group_stability(directory, rows).at("g");
    CHECK(*s.spread_db == Approx(3 / std::sqrt(2.0)));
    CHECK(*s.worst_db == 30);
    CHECK(s.elasticity.at("window").value == Approx(1));  // of 2 and 0
    CHECK(s.elasticity.at("window").high == 6);
    CHECK(s.fallback_share == Approx(0.2));
    CHECK(s.dropped_samples == 6);
    CHECK(s.failed == 0);
    REQUIRE(s.shimmer.size() == 1);
    CHECK(s.shimmer[0].with_noise == Approx(2));  // from the rows: there are no images
    CHECK_FALSE(s.shimmer[0].without_noise);
    CHECK_FALSE(s.is_limited);
    rows[0]["reference_error"]["psnr_float_db"] = 30.0;  // 2 x 1e-3 is over a tenth of 0.01
    CHECK(group_stability(directory, rows).at("g").is_limited);

    rows[1]["status"] = "failed";
    rows[1]["counts"]["non_finite_pixels"] = 7;
    const GroupStability failing = group_stability(directory, rows).at("g");
    CHECK(failing.failed == 1);
    CHECK(failing.non_finite_pixels == 7);
    CHECK_FALSE(failing.spread_db);
    // What another version of the program may have written is no reason to fall over.
    rows[0]["stability"] = {{"shimmer", {1, 2}}, {"elasticity", {{"window", 3}}}};
    CHECK(group_stability(directory, rows).at("g").shimmer.empty());
    rows[0].erase("stability");
    rows[1].erase("stability");
    CHECK(group_stability(directory, rows).empty());
}
