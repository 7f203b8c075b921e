// SPDX-License-Identifier: Apache-2.0
//
// The method auto: its schedules must say all that decides the bits.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/image_io.h"
#include "core/parallel.h"
#include "filters/auto_pilot.h"
#include "filters/methods.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/program.h"
#include "tests/record_renders.h"

using namespace vecino;

namespace {

const std::string kScenes = std::string(VECINO_SOURCE_DIR) + "/scenes/";

MethodRequest request_of(const Scene& scene, int spp) {
    RenderSettings settings;
    settings.size = {48, 40};
    settings.spp = spp;
    settings.planes = Planes{Plane::radiance};
    return {scene, settings, {}};
}

/// The flags of a schedule, read as a command line would be.
MethodRequest scheduled(const std::string& schedule, MethodRequest request, const Method*& method) {
    std::istringstream words(schedule);
    for (std::string flag, text; words >> flag >> text;) {
        if (flag == "--method") method = &find_method(text);
        if (flag == "--spp") request.settings.spp = std::stoi(text);
        nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
        if (value.is_discarded()) value = text;
        for (const MethodOption& row : method_options()) {
            if (row.flag == flag) row.set(request.parameters, JsonValue(value, "test", flag));
        }
    }
    return request;
}

}  // namespace

/// That what auto says it did gives the same bits. Returns its facts.
nlohmann::json check_schedule(const MethodRequest& request) {
    const MethodRender made = render(find_method("auto"), request);
    const Method* method = nullptr;
    const MethodRequest again = scheduled(made.facts["schedule"], request, method);
    REQUIRE(method != nullptr);
    CHECK(render(*method, again).render.frame.radiance == made.render.frame.radiance);
    return made.facts;
}

TEST_CASE("a schedule gives the bits that auto gave", "[auto]") {
    for (const char* name : {"cornell_sphere", "near_lamp"}) {
        INFO(name);
        const Scene scene = load_scene(kScenes + name + ".json");
        for (const int spp : {4, 64, 2048}) {
            INFO(spp);
            check_schedule(request_of(scene, spp));
        }
    }
}

TEST_CASE("a budget of samples gives the same bits and facts on any number of threads", "[auto]") {
    const Scene scene = load_scene(kScenes + "hard_shadows.json");
    MethodRequest request = request_of(scene, 8192);
    request.settings.threads = 1;
    const MethodRender one = render(find_method("auto"), request);
    CHECK(one.facts["pilot_compares"] == true);
    for (const int threads : {2, 7}) {
        request.settings.threads = threads;
        const MethodRender many = render(find_method("auto"), request);
        CHECK(many.render.frame.radiance == one.render.frame.radiance);
        CHECK(many.facts == one.facts);
    }
}

TEST_CASE("facts of auto say what was chosen, why, and what is expected", "[auto]") {
    const Scene scene = load_scene(kScenes + "cornell.json");
    const MethodRender result = render(find_method("auto"), request_of(scene, 8192));
    const nlohmann::json& facts = result.facts;
    CHECK(facts["chosen"] == "surface_records");
    CHECK_FALSE(facts["reason"].get<std::string>().empty());
    CHECK(facts["schedule"].get<std::string>().starts_with("--method surface_records --pilot-spp"));
    CHECK(facts["predicted_psnr_float_db"] == facts["predicted_by_method"]["surface_records"]);
    CHECK(facts["predicted_by_method"]["path"].get<double>() > 30);
    for (const char* stage : {"auto_pilot", "auto_run", "auto_predicted"})
        CHECK(result.stage_s.at(stage).get<double>() > 0);
}

TEST_CASE("light that is found by chance leaves path tracing alone", "[auto]") {
    const Scene scene = load_scene(kScenes + "cornell.json");
    MethodRequest request = request_of(scene, 64);
    request.settings.light_sampling = LightSampling::none;
    const nlohmann::json facts = render(find_method("auto"), request).facts;
    CHECK(facts["chosen"] == "path");
    CHECK_FALSE(facts["predicted_by_method"].contains("surface_records"));
}

TEST_CASE("a scene without light has no error to predict", "[auto]") {
    Scene scene = load_scene(kScenes + "cornell.json");
    for (Material& material : scene.materials) material.emission = glm::vec3(0);
    const MethodRender made = render(find_method("auto"), request_of(scene, 8192));
    CHECK(made.facts["chosen"] == "path");
    CHECK(made.facts["predicted_psnr_float_db"].is_null());
    CHECK(made.render.frame.radiance(3, 5) == glm::vec3(0));
}

TEST_CASE("the program takes a budget and says how to repeat it", "[auto]") {
    const TempDir dir;
    const std::string common = "'" + kScenes + "cornell.json' --size 64x48 --planes radiance ";
    const Outcome made =
        run_in(dir, "render " + common + "-o a.exr --method auto --time-budget 0.2");
    REQUIRE(made.code == 0);
    const std::string mark = "again by ";
    REQUIRE(made.err.find(mark) != std::string::npos);
    std::string schedule = made.err.substr(made.err.find(mark) + mark.size());
    schedule.resize(schedule.find('\n'));
    REQUIRE(run_in(dir, "render " + common + "-o b.exr " + schedule).code == 0);
    CHECK(load_frame(dir.path("a.exr")).radiance == load_frame(dir.path("b.exr")).radiance);
}

TEST_CASE("a paced frame has the bits of the plan that it ended with", "[auto]") {
    for (const char* name : {"cornell_sphere", "corridor", "open", "failures/f10_odd_size"}) {
        const Scene scene = load_scene(kScenes + name + ".json");
        for (const double seconds : {0.005, 0.05, 0.4}) {
            INFO(name << ", " << seconds);
            MethodRequest request = request_of(scene, 1);
            request.parameters.planner.time_budget_s = seconds;
            check_schedule(request);
        }
    }
}

TEST_CASE("a paced frame of several bands has the bits of its plan", "[auto]") {
    const Scene scene = load_scene(kScenes + "open.json");
    MethodRequest request = request_of(scene, 1);
    request.settings.size = {8200, 330};
    request.parameters.planner.time_budget_s = 0.5;
    CHECK(check_schedule(request)["chosen"] == "surface_records");
}

TEST_CASE("a budget that is none is one clear line", "[auto]") {
    const TempDir dir;
    const std::string start = "render '" + kScenes + "cornell.json' -o a.exr --method ";
    for (const char* bad : {"0", "-1", "nan", "inf", "1e9", "soon"}) {
        INFO(bad);
        const Outcome made = run_in(dir, start + "auto --time-budget=" + bad);
        CHECK(made.code == 64);
        CHECK(made.err.find("--time-budget") != std::string::npos);
        CHECK(std::count(made.err.begin(), made.err.end(), '\n') == 1);
    }
    const Outcome other = run_in(dir, start + "path --time-budget 1");
    CHECK(other.code == 64);
    CHECK(other.err.find("--time-budget: found with --method path, allowed: with auto") !=
          std::string::npos);
}
