// SPDX-License-Identifier: Apache-2.0
#include "eval/equal_error.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "eval/convergence.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

/// All that decides an image but its number of samples and its seed.
Json variant_params(const GroupSummary& group) {
    Json params = group.params;
    for (const char* key : {"spp", "spp_asked", "seed", "budget", "scene"}) params.erase(key);
    return params;
}

bool has_error(const GroupSummary& group) {
    return group.psnr_float_db && std::isfinite(group.psnr_float_db->mean) && group.work_s() > 0;
}

double error_of(const GroupSummary& group) {
    const auto mse = [](double db) { return std::pow(10.0, -0.1 * db); };
    const double held = mse(group.psnr_float_db->mean);
    // What is left of an error that is nearly all the reference's own is not known so well.
    constexpr double kLeast = 0.1;
    return group.reference_db ? std::max(held - mse(*group.reference_db), kLeast * held) : held;
}

bool has_budget(const GroupSummary& group) {
    const auto found = group.params.find("time_budget");
    return found != group.params.end() && found->is_number();
}

/// Groups of all scenes that differ in spp alone, as curves by scene.
struct Rival {
    Json params;
    std::string name;
    std::map<std::string, ConvergenceCurve> curves;
};

ConvergencePoint point_of(const GroupSummary& group) {
    const double error = error_of(group);
    return {group.group,    group.params["spp"].get<int>(),
            group.work_s(), {error, error, error},
            std::nullopt,   group.psnr_float_db};
}

void finish(ConvergenceCurve& curve) {
    std::ranges::sort(curve.points, {}, &ConvergencePoint::spp);
    std::vector<XY> points;
    for (const ConvergencePoint& p : curve.points)
        points.push_back({static_cast<double>(p.spp), p.error.mean});
    curve.error_by_spp = fit_power_law(points);
}

std::vector<Rival> rivals_of(std::span<const GroupSummary> groups) {
    std::vector<Rival> rivals;
    for (const GroupSummary& group : groups) {
        if (!has_error(group) || has_budget(group) || !group.params.contains("spp")) continue;
        const Json params = variant_params(group);
        auto rival = std::ranges::find(rivals, params, &Rival::params);
        if (rival == rivals.end())
            rival = rivals.insert(rivals.end(), Rival{params, group.method, {}});
        rival->curves[group.scene].points.push_back(point_of(group));
    }
    for (Rival& rival : rivals) {
        std::erase_if(rival.curves,
                      [](const auto& curve) { return curve.second.points.size() < 2; });
        for (auto& [scene, curve] : rival.curves) finish(curve);
    }
    std::erase_if(rivals, [](const Rival& rival) { return rival.curves.empty(); });
    return rivals;
}

/// Variants of one method are told apart by what varies among them.
void name_rivals(std::vector<Rival>& rivals) {
    for (Rival& rival : rivals) {
        std::string name = rival.params.value("method", rival.name);
        for (const auto& parameter : rival.params.items()) {
            const std::string& key = parameter.key();
            const Json& value = parameter.value();
            const bool varies = std::ranges::any_of(rivals, [&](const Rival& other) {
                return other.params.value("method", Json()) ==
                           rival.params.value("method", Json()) &&
                       other.params.value(key, Json()) != value;
            });
            if (varies)
                name += ", " +
                        (value.is_string() ? value.get<std::string>() : key + " " + value.dump());
        }
        rival.name = name;
    }
}

std::optional<EqualErrorFactor> factor_of(const GroupSummary& group, const Rival& rival) {
    using Kind = EqualErrorFactor::Kind;
    const auto curve = rival.curves.find(group.scene);
    if (curve == rival.curves.end()) return std::nullopt;
    const ConvergencePoint& first = curve->second.points.front();
    const double error = error_of(group);
    if (first.error.mean <= error)
        return EqualErrorFactor{first.trace_s / group.work_s(), Kind::at_most};
    const auto there = time_to_error(curve->second, error);
    if (!there) return std::nullopt;
    return EqualErrorFactor{there->time_s / group.work_s(),
                            there->is_extrapolated ? Kind::extrapolated : Kind::measured};
}

}  // namespace

EqualErrorTable equal_error(std::span<const GroupSummary> groups) {
    EqualErrorTable table;
    if (std::ranges::none_of(groups, has_budget)) return table;
    std::vector<Rival> rivals = rivals_of(groups);
    name_rivals(rivals);
    for (const Rival& rival : rivals) table.rivals.push_back(rival.name);
    for (const GroupSummary& group : groups) {
        if (!has_budget(group) || !has_error(group)) continue;
        EqualErrorRow& row = table.rows.emplace_back(EqualErrorRow{&group, error_of(group), {}});
        for (const Rival& rival : rivals) row.factors.push_back(factor_of(group, rival));
    }
    return table;
}

std::string equal_error_text(const std::optional<EqualErrorFactor>& factor) {
    if (!factor) return "–";
    const std::string text = factor_text(factor->factor);
    if (factor->kind == EqualErrorFactor::Kind::at_most) return "≤ " + text;
    return factor->kind == EqualErrorFactor::Kind::extrapolated ? text + " e" : text;
}

}  // namespace vecino
