// SPDX-License-Identifier: Apache-2.0
//
// The method auto: its arithmetic with rates that are given, and its schedules, which must say all
// that decides the bits.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/image_io.h"
#include "core/parallel.h"
#include "filters/auto_pilot.h"
#include "filters/auto_plan.h"
#include "filters/methods.h"
#include "filters/pace.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/program.h"
#include "tests/record_renders.h"

using namespace vecino;

namespace {

const std::string kScenes = std::string(VECINO_SOURCE_DIR) + "/scenes/";

/// Of a box with a sphere at 512x512.
PilotFindings usual_findings() {
    PilotFindings found;
    found.pixels = 512.0 * 512.0;
    found.needy_pixels = 14000;
    found.records_at_8 = 4300;
    found.record_growth = 3.8;
    found.path = PathErrors{1.6e-4, 1.4};
    found.records = RecordErrors{2.5e-7, 8e-7, 1e-6, 0};
    return found;
}

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

TEST_CASE("a plan fills its budget", "[auto]") {
    const PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    for (const double seconds : {0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 6.0, 60.0}) {
        INFO(seconds);
        const Schedule records = plan_surface_records(found, rates, seconds);
        CHECK(records.predicted_s <= seconds);
        CHECK(records.predicted_s >= 0.93 * seconds);
        CHECK(records.predicted_s == surface_records_cost(found, rates, records.plan));
        const Schedule path = plan_path(found, rates, seconds);
        const double packet_s = found.lanes * found.pixels * rates.path_sample_s;
        CHECK(path.spp % found.lanes == 0);
        CHECK(path.predicted_s <= std::max(seconds, 1.0001 * packet_s));
        CHECK(path.predicted_s > seconds - packet_s);
    }
}

TEST_CASE("more time is never expected to give a worse image", "[auto]") {
    const PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    double records = 1, path = 1;
    for (double seconds = 0.04; seconds < 100; seconds *= 1.3) {
        INFO(seconds);
        const double records_now = *plan_surface_records(found, rates, seconds).predicted_error;
        const double path_now = *plan_path(found, rates, seconds).predicted_error;
        CHECK(records_now <= records * 1.0001);
        CHECK(path_now <= path);
        records = records_now;
        path = path_now;
    }
}

namespace {

int finest_cell(const SurfaceRecordsPlan& plan) {
    return plan.cell >> plan.levels;
}

}  // namespace

TEST_CASE("cells shrink as budgets grow, and sooner where cells are what is wrong", "[auto]") {
    PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    CHECK(finest_cell(plan_surface_records(found, rates, 0.06).plan) >= 8);
    CHECK(finest_cell(plan_surface_records(found, rates, 4).plan) <= 4);
    const int usual = finest_cell(plan_surface_records(found, rates, 0.1).plan);
    found.records->bias_at_8 *= 100;
    CHECK(finest_cell(plan_surface_records(found, rates, 0.1).plan) < usual);
}

TEST_CASE("a budget that nothing fits gets the least of everything", "[auto]") {
    const PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    CHECK(plan_path(found, rates, 1e-6).spp == found.lanes);
    const Schedule least = plan_surface_records(found, rates, 1e-6);
    CHECK(least.plan.pilot_spp == 1);
    CHECK(least.plan.record_paths >= 1);
    CHECK(least.predicted_s > 1e-6);
}

TEST_CASE("what the pilot found decides between methods", "[auto]") {
    PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    CHECK_FALSE(choose_schedule(found, rates, 1).takes_path);
    found.records->unexplained = 0.01;  // paths say something else
    CHECK(choose_schedule(found, rates, 1).takes_path);
    found.path.reset();  // no time to find out
    CHECK_FALSE(choose_schedule(found, rates, 1).takes_path);
    found.has_records_method = false;
    CHECK(choose_schedule(found, rates, 1).takes_path);
    CHECK_FALSE(choose_schedule(found, rates, 1).records.has_value());
}

TEST_CASE("of methods that are equal within half a decibel, path is taken", "[auto]") {
    PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    const double records = *plan_surface_records(found, rates, 1).predicted_error;
    const double now = *plan_path(found, rates, 1).predicted_error;
    found.path->at_16_spp *= records / now * 1.11;
    CHECK(choose_schedule(found, rates, 1).takes_path);
    found.path->at_16_spp *= 1.03;
    CHECK_FALSE(choose_schedule(found, rates, 1).takes_path);
}

TEST_CASE("where path tracing leaves nothing that could be seen, it is taken", "[auto]") {
    PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    const double spp = plan_path(found, rates, 1).spp;
    found.records = RecordErrors{};  // by far the better
    found.path = PathErrors{6e-8 * spp / 16, 1};
    CHECK(choose_schedule(found, rates, 1).takes_path);
    found.path->at_16_spp *= 1.1;
    CHECK_FALSE(choose_schedule(found, rates, 1).takes_path);
}

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

TEST_CASE("a pace begins where there is most to do, and knows that it is not so everywhere",
          "[auto]") {
    const std::vector<BandRows> bands{{{0, 256}, {0, 256}}, {{256, 512}, {256, 512}}};
    const auto edges_of_second = [&](double first_needy) {
        std::vector<BandRows> order = bands;
        Pace pace(1, 2, usual_findings());
        pace.begin();
        pace.choose_first(order, {{131072, first_needy, 500, 1e-3}, {131072, 8000, 500, 1e-3}});
        CHECK(order.front().made.begin == 256);
        SurfaceRecordsPlan plan = Pace::first_plan();
        pace.choose_structure({8000, 500, 8e-7, true, 6e-8, 4e-8}, plan);
        pace.choose_edges([](int edge_spp) { return 8000.0 * edge_spp; }, 4e-8, plan);
        return plan.edge_spp;
    };
    // Half of the time, and all of what there is to do in it, or half of that.
    const double ratio = double{1} * edges_of_second(0) / edges_of_second(7999);
    CHECK(ratio > 1.9);
    CHECK(ratio < 2.1);
}

TEST_CASE("a pace gives to records and samples what the time allows", "[auto]") {
    const PilotFindings found = usual_findings();
    const PaceFindings here{14000, 1150, 8e-7, true, 6e-8, 4e-8};
    const auto edges_in = [&](double seconds, int threads) {
        Pace pace(seconds, threads, found);
        pace.begin();
        SurfaceRecordsPlan plan = Pace::first_plan();
        pace.choose_pilot({4e-8, 16e-8}, plan);
        pace.choose_structure(here, plan);
        pace.choose_paths({0, 4300, 3e-8}, plan);
        pace.choose_edges([](int edge_spp) { return 14000.0 * (edge_spp + 25); }, 4e-8, plan);
        return plan;
    };
    const SurfaceRecordsPlan little = edges_in(0.1, 2), much = edges_in(2, 2);
    CHECK(little.pilot_spp < much.pilot_spp);
    CHECK(finest_cell(little) > finest_cell(much));
    CHECK(little.edge_spp < much.edge_spp);
    CHECK(little.record_paths < much.record_paths);
    // Nothing took any time here but the choices: all of it is there for samples.
    CHECK(much.edge_spp > 1000);
    CHECK(edges_in(2, 16).edge_spp > 2 * much.edge_spp);
    CHECK(edges_in(1e-6, 2).edge_spp >= 1);
}

TEST_CASE("paths at edges are for records that are wrong there by more than paths are noisy",
          "[auto]") {
    Pace pace(1, 2, usual_findings());
    pace.begin();
    SurfaceRecordsPlan plan = Pace::first_plan();
    pace.choose_structure({14000, 1150, 8e-7, true, 6e-8, 4e-8}, plan);
    plan.edge_spp = 600;
    const auto wants = [&](double error, double standard_error, double path_noise) {
        return pace.wants_paths({0.05, 7000, {error, standard_error, path_noise}, {}}, plan, false);
    };
    CHECK(wants(1e-4, 1e-5, 1e-2));
    CHECK_FALSE(wants(1e-4, 1e-5, 1));     // 200 paths leave more than records do
    CHECK_FALSE(wants(1e-4, 1e-4, 1e-2));  // it may be noise
    CHECK_FALSE(wants(1e-5, 1e-6, 1e-2));  // samples that are lost cost more
    CHECK_FALSE(wants(0, 0, 0));           // nothing is known
    // Lamps that are known exactly are worth something: far less has to be left, for sure.
    const auto wants_with_lamps = [&](double error, double standard_error) {
        return pace.wants_paths({0.05, 7000, {error, standard_error, 1e-2}, {}}, plan, true);
    };
    CHECK_FALSE(wants_with_lamps(1e-4, 1e-5));
    CHECK(wants_with_lamps(1e-3, 1e-4));
    CHECK_FALSE(wants_with_lamps(1e-3, 4e-4));
    plan.edge_spp = 20;
    CHECK_FALSE(wants(1, 1e-5, 1e-2));  // too few to have a third of them
}

TEST_CASE("the error that a paced frame expects is about what it has", "[auto]") {
    constexpr int kReferenceSpp = 4096;  // far better than what is held against it
    for (const char* name : {"cornell_sphere", "corridor", "failures/f16_soft_shadow"}) {
        INFO(name);
        const Scene scene = load_scene(kScenes + name + ".json");
        RenderSettings settings;
        settings.size = {128, 128};
        settings.max_depth = 2;
        settings.planes = Planes{Plane::radiance};
        PilotFindings found;
        found.pixels = 128.0 * 128.0;
        Pace pace(0.2, default_thread_count(), found);
        const StagedRender made =
            render_in_stages(scene, settings, {Pace::first_plan(), &pace}, {});
        REQUIRE(made.expected_error.has_value());
        const double error =
            test::db(made.render.frame.radiance, test::paths(scene, settings, kReferenceSpp));
        const double expected = -10 * std::log10(*made.expected_error);
        CHECK(expected > error - 9);
        CHECK(expected < error + 9);
    }
}

TEST_CASE("a machine that is busy is given less to do", "[auto]") {
    const PilotFindings found = usual_findings();
    const auto paths_on = [&](double slowness) {
        Pace pace(1, 2, found);
        pace.begin();
        SurfaceRecordsPlan plan = Pace::first_plan();
        pace.choose_pilot({4e-8, 16e-8}, plan);
        pace.take_pilot(0.2, 0.1 * slowness, 0);
        pace.choose_structure({14000, 1150, 8e-7, true, 6e-8, 4e-8}, plan);
        pace.choose_paths({0, 4300, 3e-8 * slowness}, plan);
        const double per_record =
            plan.record_paths + refined_share(plan, 3.8) * plan.refined_record_paths;
        return per_record / (plan.cell * plan.cell);
    };
    CHECK(paths_on(4) < 0.5 * paths_on(1));
}

TEST_CASE("first samples are traced again, and more of them, only where that pays", "[auto]") {
    // What samples of needy pixels leave, with few first ones and with four times as many.
    const auto curve = [](double error) {
        EdgeCurve edges;
        for (int spp = 1; spp <= 1024; spp *= 2)
            edges.push_back({1.0 * spp, 10.0 + spp, error / spp});
        return edges;
    };
    const auto pilot_of = [&](double error_with_more, double pilot_s) {
        Pace pace(1, 2, usual_findings());
        pace.begin();
        SurfaceRecordsPlan plan = Pace::first_plan();
        pace.choose_pilot({1e-6, 4e-6}, plan);  // so slow that there is time for one
        CHECK(plan.pilot_spp == 1);
        pace.take_pilot(2 * pilot_s, pilot_s, 0);
        PaceFindings here{100000, 1150, 8e-7, true, 6e-8, 4e-8};
        here.edges = {{1, curve(1e-2)}, {4, curve(error_with_more)}};
        pace.choose_structure(here, plan);
        return plan.pilot_spp;
    };
    CHECK(pilot_of(1e-3, 0.02) == 4);
    CHECK(pilot_of(1e-2, 0.02) == 1);  // they would tell nothing
    CHECK(pilot_of(1e-3, 0.5) == 1);   // there is no time
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
