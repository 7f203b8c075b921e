// SPDX-License-Identifier: Apache-2.0
//
// The arithmetic of the method auto, and its clock, with rates that are given.
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "filters/auto_plan.h"
#include "filters/pace.h"
#include "tests/catch.h"
#include "tests/pilot_findings.h"
#include "tests/record_renders.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

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

TEST_CASE("path tracing is taken where it is expected to be two decibels better", "[auto]") {
    PilotFindings found = usual_findings();
    const CostRates rates = nominal_rates(3.4);
    const double records = *plan_surface_records(found, rates, 1).predicted_error;
    const double now = *plan_path(found, rates, 1).predicted_error;
    found.path->at_16_spp *= records / now / 1.61;
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

TEST_CASE("bands are the same for all cells that a pace chooses among", "[auto]") {
    const Scene scene = repository_scene("open");
    RenderSettings settings;
    settings.size = {8200, 300};
    settings.max_depth = 0;
    settings.planes = Planes{Plane::radiance};
    SurfaceRecordsPlan plan = Pace::first_plan();
    plan.edge_spp = 0;
    const int rows = render_in_stages(scene, settings, {plan}, {}).counts.band_rows;
    CHECK(rows < 300);
    for (const int cell : {4, 8, 12}) {
        plan.cell = cell;
        CHECK(render_in_stages(scene, settings, {plan}, {}).counts.band_rows == rows);
    }
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
    CHECK(wants(4e-5, 1e-6, 1e-2));
    CHECK_FALSE(wants_with_lamps(4e-5, 1e-6));
    CHECK(wants_with_lamps(1e-3, 1e-4));
    CHECK_FALSE(wants_with_lamps(1e-3, 4e-4));
    plan.edge_spp = 20;
    CHECK_FALSE(wants(1, 1e-5, 1e-2));  // too few to have a third of them
}

TEST_CASE("the error that a paced frame expects is about what it has", "[auto]") {
    constexpr int kReferenceSpp = 4096;  // far better than what is held against it
    for (const char* name : {"cornell_sphere", "corridor", "failures/f16_soft_shadow"}) {
        INFO(name);
        const Scene scene = repository_scene(name);
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
        const double error = db(made.render.frame.radiance, paths(scene, settings, kReferenceSpp));
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
