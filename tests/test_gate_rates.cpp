// SPDX-License-Identifier: Apache-2.0
//
// How often the gate cries wolf, and how often it sees a wolf. From drawn numbers in every run of
// the tests; from renders on demand: vecino_tests "[rates]".
#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "core/image_io.h"
#include "core/render.h"
#include "eval/metrics_json.h"
#include "eval/reference_store.h"
#include "eval/regions.h"
#include "filters/schemes.h"
#include "tests/catch.h"
#include "tests/gate_groups.h"

using namespace vecino;

namespace {

constexpr int kBaselineSeeds = 8;
constexpr int kCheckSeeds = 4;

/// psnr_float_db of seeds whose errors are log-normal: a deviation in dB around 30 dB.
std::vector<double> drawn(int seeds, double deviation_db, std::mt19937& generator) {
    std::normal_distribution<double> normal(30.0, deviation_db);
    std::vector<double> values;
    for (int i = 0; i < seeds; ++i) values.push_back(normal(generator));
    return values;
}

/// Share of trials in which the mean fails, each with a baseline and a check of its own.
double failing_share(const GateClass& gate, double loss_db, int trials) {
    std::mt19937 generator(7);
    int failed = 0;
    for (int i = 0; i < trials; ++i) {
        const RunGroup then = group_of(drawn(kBaselineSeeds, 0.15, generator));
        std::vector<double> now = drawn(kCheckSeeds, 0.15, generator);
        for (double& value : now) value -= loss_db;
        failed += judged(group_of(now), then, gate).outcome == GateOutcome::fail ? 1 : 0;
    }
    return static_cast<double>(failed) / trials;
}

}  // namespace

TEST_CASE("without a tolerance, the mean cries wolf as rarely as it says", "[gate]") {
    // Two sigma are 2.3 %; 4000 trials tell that to 0.24 % (one standard error).
    const GateClass gate = class_judging("psnr_float_db", 0.0, 2);
    const double share = failing_share(gate, 0, 4000);
    CHECK(share > 0.013);
    CHECK(share < 0.033);
}

TEST_CASE("with a tolerance, false alarms are rare and losses of 0.5 dB and more are seen",
          "[gate]") {
    const GateClass gate = class_judging("psnr_float_db", 0.1);
    CHECK(failing_share(gate, 0.0, 3000) < 0.0005);
    CHECK(failing_share(gate, 0.1, 3000) < 0.006);  // within the tolerance
    CHECK(failing_share(gate, 0.5, 1000) > 0.5);
    CHECK(failing_share(gate, 1.0, 1000) > 0.999);
}

namespace {

/// What is rendered, and how large images come of it.
struct Subject {
    std::string name;
    RenderSettings settings;
    const Scheme* scheme = nullptr;
    SchemeParameters parameters;
};

std::vector<Subject> subjects() {
    RenderSettings chance;
    chance.size = {32, 32};
    chance.spp = 64;
    chance.light_sampling = LightSampling::none;
    chance.sampler = Sampler::independent;
    RenderSettings nee = chance;
    nee.light_sampling = LightSampling::nee;
    nee.spp = 16;
    const auto scheme = [](RenderSettings settings, const char* name, int window) {
        settings.reduction = 2;
        Subject subject{
            std::string(name) + ".w" + std::to_string(window), settings, &find_scheme(name), {}};
        subject.parameters.window = window;
        return subject;
    };
    return {{"path by chance", chance, nullptr, {}},
            {"path nee", nee, nullptr, {}},
            scheme(chance, "mean", 3),
            scheme(nee, "distance3d_normal", 7),
            scheme(nee, "nearest", 3)};
}

class Lab {
  public:
    Lab() : scene_(load_scene(VECINO_SOURCE_DIR "/scenes/cornell.json")) {
        RenderSettings settings;
        settings.size = {32, 32};
        settings.spp = 4096;
        settings.seed = 100000;
        settings.planes = reference_planes();
        Frame frame = render(scene_, settings).frame;
        regions_ = regions_of(frame);
        reference_ = std::move(frame.radiance);
    }

    Image image(const Subject& subject, std::uint32_t seed) const {
        RenderSettings settings = subject.settings;
        settings.seed = seed;
        if (subject.scheme != nullptr) {
            settings.planes.add(subject.scheme->needs);
            settings.planes.add(Plane::id);
        }
        Frame frame = render(scene_, settings).frame;
        if (subject.scheme == nullptr) return std::move(frame.radiance);
        return reconstruct(frame, *subject.scheme, {{32, 32}, subject.parameters, 0}).image;
    }

    /// The row of an image whose deviation from the reference is scaled by decibels.
    nlohmann::json row(const Image& image, double loss_db) const {
        const auto factor = static_cast<float>(std::pow(10.0, loss_db / 20));
        Image worse = reference_;
        for (std::size_t i = 0; i < worse.values().size(); ++i)
            worse.values()[i] += factor * (image.values()[i] - reference_.values()[i]);
        return {{"metrics", comparison_json(compare(worse, reference_, &regions_))}};
    }

  private:
    Scene scene_;
    Image reference_;
    RegionMap regions_;
};

struct Tally {
    int checks = 0, alarms = 0, comparisons = 0;
    std::map<std::string, int> by_rule;

    void add(const std::vector<Verdict>& verdicts) {
        bool alarm = false;
        for (const Verdict& verdict : verdicts) {
            ++comparisons;
            if (verdict.outcome != GateOutcome::fail) continue;
            alarm = true;
            ++by_rule[verdict.rule + " " + verdict.metric];
        }
        ++checks;
        alarms += alarm ? 1 : 0;
    }

    void print(const std::string& label) const {
        std::printf("  %-28s %4d of %d checks fail (%.2f %%)", label.c_str(), alarms, checks,
                    100.0 * alarms / checks);
        for (const auto& [rule, count] : by_rule) std::printf("  %s: %d", rule.c_str(), count);
        std::printf("\n");
    }
};

GateClass without_tolerance() {
    GateClass gate = default_gate_class();
    for (auto& [metric, tolerance] : gate.tolerance_db) tolerance = 0;
    return gate;
}

}  // namespace

TEST_CASE("rates of false alarms and of detection", "[.][benchmark][rates]") {
    constexpr int kBaselines = 20;
    constexpr int kChecks = 25;  // of each baseline
    constexpr double kLosses_db[] = {0.1, 0.2, 0.5, 1.0};
    const Lab lab;
    const GateClass gate = default_gate_class();
    Tally all;
    for (const Subject& subject : subjects()) {
        std::uint32_t seed = 1;
        const auto group = [&](int seeds, auto&& add) {
            for (int i = 0; i < seeds; ++i) add(lab.image(subject, seed++));
        };
        Tally unchanged, strict;
        std::map<double, Tally> damaged;
        for (int b = 0; b < kBaselines; ++b) {
            RunGroup then;
            group(kBaselineSeeds, [&](const Image& i) { then.rows.push_back(lab.row(i, 0)); });
            const BaselineGroup baseline = baseline_of(then, gate);
            for (int c = 0; c < kChecks; ++c) {
                std::map<double, RunGroup> now;
                group(kCheckSeeds, [&](const Image& image) {
                    now[0].rows.push_back(lab.row(image, 0));
                    for (const double loss : kLosses_db)
                        now[loss].rows.push_back(lab.row(image, loss));
                });
                unchanged.add(judge_quality(now[0], gate, baseline));
                all.add(judge_quality(now[0], gate, baseline));
                strict.add(judge_quality(now[0], without_tolerance(), baseline));
                for (const double loss : kLosses_db)
                    damaged[loss].add(judge_quality(now[loss], gate, baseline));
            }
        }
        std::printf("%s\n", subject.name.c_str());
        unchanged.print("unchanged");
        strict.print("unchanged, no tolerance");
        for (const auto& [loss, tally] : damaged)
            tally.print("error + " + std::to_string(loss).substr(0, 3) + " dB");
    }
    all.print("all unchanged");
    std::printf("  %d comparisons\n", all.comparisons);
    CHECK(all.alarms * 50 <= all.checks);  // below 2 % of checks of a group
}
