// SPDX-License-Identifier: Apache-2.0
#include "eval/convergence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "eval/commands.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

constexpr double kJudgedSpp = 64;

/// All that decides a path traced image but its number of samples and its seed.
Json variant_params(const GroupSummary& group) {
    Json params = group.params;
    for (const char* key : {"method", "spp", "spp_asked", "seed", "budget"}) params.erase(key);
    return params;
}

bool is_path(const GroupSummary& group) {
    return group.method == "path" && group.params.contains("spp") && group.relmse &&
           group.relmse->mean > 0 && group.trace_s > 0;
}

ConvergencePoint point_of(const GroupSummary& group) {
    ConvergencePoint point{group.group,   group.params["spp"].get<int>(),
                           group.trace_s, *group.relmse,
                           std::nullopt,  group.psnr_float_db};
    const SeedStatistics* const statistics = group.statistics_of("");
    if (statistics != nullptr) point.variance = statistics->relative.noise;
    return point;
}

template <class X, class Y>
std::optional<PowerLaw> fit(const ConvergenceCurve& curve, X x, Y y) {
    std::vector<XY> points;
    for (const ConvergencePoint& p : curve.points) points.push_back({x(p), y(p)});
    return fit_power_law(points);
}

double log_distance(const ConvergencePoint& point, double spp) {
    return std::abs(std::log(point.spp / spp));
}

void describe(ConvergenceCurve& curve) {
    const auto spp = [](const ConvergencePoint& p) { return static_cast<double>(p.spp); };
    const auto time = [](const ConvergencePoint& p) { return p.trace_s; };
    const auto error = [](const ConvergencePoint& p) { return p.error.mean; };
    const auto variance = [](const ConvergencePoint& p) { return p.variance.value_or(0); };
    std::ranges::sort(curve.points, {}, &ConvergencePoint::spp);
    curve.error_by_spp = fit(curve, spp, error);
    curve.variance_by_spp = fit(curve, spp, variance);
    curve.error_by_time = fit(curve, time, error);
    const auto judged = std::ranges::min_element(
        curve.points, {}, [](const ConvergencePoint& p) { return log_distance(p, kJudgedSpp); });
    curve.judged = static_cast<std::size_t>(judged - curve.points.begin());
    const auto value = [&](const char* key) { return curve.params.value(key, Json()); };
    curve.is_baseline = value("light_sampling") == "none" && value("sampler") == "independent";
}

/// Samples of the whole image, from its size: what a rate is of.
double samples_per_s(const ConvergenceCurve& curve) {
    const auto longest = std::ranges::max_element(curve.points, {}, &ConvergencePoint::trace_s);
    const Json size = curve.params.value("size", Json());
    if (!size.is_array() || size.size() != 2) return 0;
    return size[0].get<double>() * size[1].get<double>() * longest->spp / longest->trace_s;
}

std::vector<ConvergenceCurve> curves_of(std::span<const GroupSummary> groups) {
    std::vector<ConvergenceCurve> curves;
    for (const GroupSummary& group : groups) {
        if (!is_path(group)) continue;
        const Json params = variant_params(group);
        const auto same = [&](const ConvergenceCurve& c) {
            return c.scene == group.scene && c.params == params;
        };
        auto curve = std::ranges::find_if(curves, same);
        if (curve == curves.end()) {
            curve = curves.emplace(curve);
            curve->scene = group.scene;
            curve->params = params;
        }
        curve->points.push_back(point_of(group));
    }
    std::erase_if(curves, [](const ConvergenceCurve& c) { return c.points.size() < 2; });
    return curves;
}

/// What varies among curves that find light the same way: light found by chance reads no option of
/// next-event estimation, and shows none.
std::vector<std::string> varying_keys(std::span<const ConvergenceCurve> curves,
                                      const Json& sampling) {
    std::vector<std::string> keys;
    for (const RenderOption& row : render_options()) {
        const std::string key(row.name);
        std::set<Json> values;
        for (const ConvergenceCurve& curve : curves) {
            if (curve.params.value("light_sampling", Json()) == sampling)
                values.insert(curve.params.value(key, Json()));
        }
        if (values.size() > 1) keys.push_back(key);
    }
    return keys;
}

std::string value_text(const std::string& key, const Json& value) {
    if (!value.is_string()) return key + " " + value.dump();
    const auto text = value.get<std::string>();
    return text == "none" ? "no " + key : text;
}

std::string variant_text(const ConvergenceCurve& curve, const std::vector<std::string>& keys) {
    const Json sampling = curve.params.value("light_sampling", Json("path"));
    std::string text = sampling.is_string() ? sampling.get<std::string>() : sampling.dump();
    for (const std::string& key : keys) {
        if (!curve.params.contains(key)) continue;
        text += ", " + value_text(key, curve.params[key]);
    }
    return text;
}

void name_variants(std::vector<ConvergenceCurve>& curves) {
    for (ConvergenceCurve& curve : curves) {
        const Json sampling = curve.params.value("light_sampling", Json());
        curve.variant = variant_text(curve, varying_keys(curves, sampling));
    }
}

/// The scene's baseline that makes the same image.
const ConvergenceCurve* baseline_of(const ConvergenceCurve& curve,
                                    std::span<const ConvergenceCurve> curves) {
    const auto fits = [&](const ConvergenceCurve& other) {
        const auto agree = [&](const char* key) {
            return other.params.value(key, Json()) == curve.params.value(key, Json());
        };
        return other.is_baseline && other.scene == curve.scene && agree("size") &&
               agree("max_depth");
    };
    const auto found = std::ranges::find_if(curves, fits);
    return found == curves.end() ? nullptr : &*found;
}

void set_speed_ups(std::vector<ConvergenceCurve>& curves) {
    for (ConvergenceCurve& curve : curves) {
        const ConvergenceCurve* const baseline = baseline_of(curve, curves);
        if (baseline == nullptr || curve.is_baseline) continue;
        curve.speed_up = speed_up(curve, *baseline, curve.points[curve.judged].error.mean);
        curve.common = common_speed_up(curve, *baseline);
    }
}

Json law_json(const std::optional<PowerLaw>& law) {
    if (!law) return nullptr;
    return {{"slope", law->slope},
            {"slope_error", law->slope_error ? Json(*law->slope_error) : Json(nullptr)},
            {"factor", law->factor}};
}

Json point_json(const ConvergencePoint& point) {
    return {{"group", point.group},
            {"spp", point.spp},
            {"trace_s", point.trace_s},
            {"relmse", estimate_json(point.error)},
            {"variance", point.variance ? Json(*point.variance) : Json(nullptr)},
            {"psnr_float_db", estimate_json(point.psnr_float_db)}};
}

Json common_json(const CommonSpeedUp& common) {
    return {{"factor", common.factor},
            {"least_relmse", common.least_error},
            {"most_relmse", common.most_error}};
}

Json curve_json(const ConvergenceCurve& curve) {
    Json points = Json::array();
    for (const ConvergencePoint& point : curve.points) points.push_back(point_json(point));
    Json speed_up = nullptr;
    if (curve.speed_up) {
        speed_up = {{"factor", curve.speed_up->factor},
                    {"extrapolated", curve.speed_up->is_extrapolated}};
    }
    return {{"scene", curve.scene},
            {"variant", curve.variant},
            {"baseline", curve.is_baseline},
            {"points", points},
            {"error_by_spp", law_json(curve.error_by_spp)},
            {"variance_by_spp", law_json(curve.variance_by_spp)},
            {"error_by_time", law_json(curve.error_by_time)},
            {"samples_per_s", curve.samples_per_s},
            {"judged", curve.judged},
            {"speed_up", speed_up},
            {"common_speed_up", curve.common ? common_json(*curve.common) : Json(nullptr)}};
}

std::string table_line(const ConvergenceCurve& curve) {
    const ConvergencePoint& judged = curve.points[curve.judged];
    char speed[32] = "-";
    if (curve.is_baseline) std::snprintf(speed, sizeof speed, "1");
    if (curve.speed_up) {
        std::snprintf(speed, sizeof speed, "%.4g%s", curve.speed_up->factor,
                      curve.speed_up->is_extrapolated ? " e" : "  ");
    }
    char common[64] = "";
    if (curve.common) {
        std::snprintf(common, sizeof common, "%.4g at %.1f to %.1f", curve.common->factor,
                      error_in_db(curve.common->most_error),
                      error_in_db(curve.common->least_error));
    }
    char line[192];
    std::snprintf(line, sizeof line, "  %-14s %5d  %8.2f  %8.3f  %10s  %s\n",
                  slope_text(curve.error_by_spp).c_str(), judged.spp,
                  error_in_db(judged.error.mean), 1e-6 * curve.samples_per_s, speed, common);
    return line;
}

}  // namespace

double PowerLaw::at(double x) const {
    return factor * std::pow(x, slope);
}

std::optional<PowerLaw> fit_power_law(std::span<const XY> points) {
    std::vector<XY> logs;
    for (const XY& p : points) {
        if (p.x > 0 && p.y > 0) logs.push_back({std::log(p.x), std::log(p.y)});
    }
    const auto n = static_cast<double>(logs.size());
    XY mean;
    for (const XY& p : logs) mean = {mean.x + p.x / n, mean.y + p.y / n};
    double xx = 0;
    double xy = 0;
    for (const XY& p : logs) {
        xx += (p.x - mean.x) * (p.x - mean.x);
        xy += (p.x - mean.x) * (p.y - mean.y);
    }
    if (logs.size() < 2 || !(xx > 0)) return std::nullopt;
    PowerLaw law{xy / xx, std::exp(mean.y - xy / xx * mean.x), std::nullopt};
    if (logs.size() < 3) return law;
    double residuals = 0;
    for (const XY& p : logs) {
        const double off = p.y - mean.y - law.slope * (p.x - mean.x);
        residuals += off * off;
    }
    law.slope_error = std::sqrt(residuals / (n - 2) / xx);
    return law;
}

std::optional<TimeToError> time_to_error(const ConvergenceCurve& curve, double error) {
    const ConvergencePoint& last = curve.points.back();
    if (error < last.error.mean) {
        if (!curve.error_by_spp || !(curve.error_by_spp->slope < 0)) return std::nullopt;
        const double more = std::pow(error / last.error.mean, 1 / curve.error_by_spp->slope);
        return TimeToError{last.trace_s * more, true};
    }
    // From the end: once reached, an error is to stay so.
    for (std::size_t i = curve.points.size() - 1; i > 0; --i) {
        const ConvergencePoint& from = curve.points[i - 1];
        const ConvergencePoint& to = curve.points[i];
        if (from.error.mean < error) continue;
        const double part = std::log(from.error.mean / error) /
                            std::max(std::log(from.error.mean / to.error.mean), 1e-12);
        return TimeToError{from.trace_s * std::pow(to.trace_s / from.trace_s, part), false};
    }
    return std::nullopt;
}

std::optional<SpeedUp> speed_up(const ConvergenceCurve& of, const ConvergenceCurve& over,
                                double error) {
    const auto own = time_to_error(of, error);
    const auto other = time_to_error(over, error);
    if (!own || !other || own->is_extrapolated) return std::nullopt;
    return SpeedUp{other->time_s / own->time_s, other->is_extrapolated};
}

std::optional<CommonSpeedUp> common_speed_up(const ConvergenceCurve& of,
                                             const ConvergenceCurve& over) {
    CommonSpeedUp result;
    result.least_error = std::max(of.points.back().error.mean, over.points.back().error.mean);
    result.most_error = std::min(of.points.front().error.mean, over.points.front().error.mean);
    if (!(result.least_error < result.most_error)) return std::nullopt;
    constexpr int kSteps = 64;  // midpoints: the ends of a curve may be missed by rounding
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double part = (i + 0.5) / kSteps;
        const double error =
            result.least_error * std::pow(result.most_error / result.least_error, part);
        const auto there = speed_up(of, over, error);
        if (!there) return std::nullopt;
        sum += std::log(there->factor);
    }
    result.factor = std::exp(sum / kSteps);
    return result;
}

std::vector<ConvergenceCurve> convergence(std::span<const GroupSummary> groups) {
    std::vector<ConvergenceCurve> curves = curves_of(groups);
    for (ConvergenceCurve& curve : curves) {
        describe(curve);
        curve.samples_per_s = samples_per_s(curve);
    }
    name_variants(curves);
    std::map<std::string, std::size_t> scenes;
    for (const ConvergenceCurve& curve : curves) scenes.try_emplace(curve.scene, scenes.size());
    std::ranges::stable_sort(curves, {}, [&](const ConvergenceCurve& curve) {
        return 2 * scenes.at(curve.scene) + (curve.is_baseline ? 0 : 1);
    });
    set_speed_ups(curves);
    return curves;
}

Json convergence_json(std::span<const ConvergenceCurve> curves) {
    Json json = Json::array();
    for (const ConvergenceCurve& curve : curves) json.push_back(curve_json(curve));
    return json;
}

std::string convergence_table(std::span<const ConvergenceCurve> curves) {
    if (curves.empty()) return "";
    std::size_t width = 0;
    const auto name = [](const ConvergenceCurve& c) { return c.scene + ": " + c.variant; };
    for (const ConvergenceCurve& curve : curves) width = std::max(width, name(curve).size());
    std::string table = "convergence";
    table.resize(width, ' ');
    char head[192];
    std::snprintf(head, sizeof head, "  %-14s %5s  %8s  %8s  %10s  %s\n", "slope by spp", "spp",
                  "relMSE dB", "M/s", "speed-up", "where both are measured, dB");
    table += head;
    for (const ConvergenceCurve& curve : curves) {
        std::string padded = name(curve);
        padded.resize(width, ' ');
        table += padded + table_line(curve);
    }
    return table + "speed-up: time to the same relMSE as at that spp, of light found by chance " +
           "with independent samples over this; e: it is extrapolated along its slope\n";
}

std::string factor_text(double factor) {
    const int decimals = factor < 10 ? 2 : factor < 100 ? 1 : 0;
    return "× " + number_text(factor, decimals);
}

double error_in_db(double error) {
    return -10 * std::log10(error);
}

std::string slope_text(const std::optional<PowerLaw>& law) {
    if (!law) return "-";
    char text[48];
    if (law->slope_error) {
        std::snprintf(text, sizeof text, "%.2f +-%.2f", law->slope, *law->slope_error);
    } else {
        std::snprintf(text, sizeof text, "%.2f", law->slope);
    }
    return text;
}

}  // namespace vecino
