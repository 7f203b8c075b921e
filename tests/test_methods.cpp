// SPDX-License-Identifier: Apache-2.0
//
// What holds for every row of the table of render methods.
#include <algorithm>
#include <set>

#include "core/error.h"
#include "filters/methods.h"
#include "tests/catch.h"
#include "tests/error_of.h"

using namespace vecino;

namespace {

const std::string kBox = std::string(VECINO_SOURCE_DIR) + "/scenes/cornell_sphere.json";

MethodRequest small_request(const Scene& scene) {
    RenderSettings settings;
    settings.size = {24, 17};
    settings.spp = 8;
    return {scene, settings, {}};
}

}  // namespace

TEST_CASE("methods have names of their own and read options that exist", "[methods]") {
    std::set<std::string_view> names;
    for (const Method& method : all_methods()) {
        INFO(method.name);
        CHECK(names.insert(method.name).second);
        CHECK_FALSE(method.summary.empty());
        CHECK(&find_method(method.name) == &method);
        for (const std::string_view option : method.options) {
            INFO(option);
            const auto rows = method_options();
            CHECK(std::ranges::find(rows, option, &MethodOption::name) != rows.end());
            CHECK(method.reads(option));
        }
        CHECK_FALSE(method.reads("no such option"));
    }
    CHECK(all_methods().front().name == "path");
}

TEST_CASE("an unknown method is an error that names the known ones", "[methods]") {
    const Error error = error_of([] { (void)find_method("pathe"); });
    CHECK(error.code() == ExitCode::usage);
    CHECK(std::string(error.what()).starts_with("method: found \"pathe\", allowed: path"));
}

TEST_CASE("every method gives the same bits with any number of threads", "[methods]") {
    const Scene scene = load_scene(kBox);
    for (const Method& method : all_methods()) {
        INFO(method.name);
        MethodRequest request = small_request(scene);
        request.settings.threads = 1;
        const MethodRender one = render(method, request);
        CHECK(one.render.frame.size() == request.settings.size);
        for (const int threads : {2, 7}) {
            request.settings.threads = threads;
            const MethodRender many = render(method, request);
            CHECK(many.render.frame.radiance == one.render.frame.radiance);
            CHECK(many.facts == one.facts);
        }
    }
}

TEST_CASE("every method stops when its progress says so", "[methods]") {
    const Scene scene = load_scene(kBox);
    for (const Method& method : all_methods()) {
        INFO(method.name);
        const auto stop = [](double) { return false; };
        const Error error = error_of([&] { (void)render(method, small_request(scene), stop); });
        CHECK(error.code() == ExitCode::interrupted);
    }
}

TEST_CASE("every method fills in a pattern", "[methods]") {
    const Scene scene = load_scene(std::string(VECINO_SOURCE_DIR) + "/scenes/illustration_9.json");
    for (const Method& method : all_methods()) {
        INFO(method.name);
        const Image image = render(method, small_request(scene)).render.frame.radiance;
        CHECK(image(0, 0).x == Approx(0.5 / 24));
        CHECK(image(23, 16).y == Approx(16.5 / 17));
    }
}
