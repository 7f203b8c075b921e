// SPDX-License-Identifier: Apache-2.0
#include "eval/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/timing.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

std::vector<double> values_of(const std::vector<const Json*>& rows, const char* section,
                              const char* key) {
    std::vector<double> values;
    for (const Json* row : rows) {
        const Json value = row->value(section, Json::object()).value(key, Json());
        if (value.is_number()) values.push_back(value.get<double>());
    }
    return values;
}

/// An estimate only if every row has the value: leaving one out would flatter the rest.
template <class Estimator>
std::optional<Estimate> metric(const std::vector<const Json*>& rows, const char* key,
                               Estimator estimator) {
    const auto values = values_of(rows, "metrics", key);
    if (values.empty() || values.size() != rows.size()) return std::nullopt;
    return estimator(values);
}

/// Of the regions that every row has a value of.
PerRegion<std::optional<Estimate>> region_metric(const std::vector<const Json*>& rows,
                                                 const char* key) {
    PerRegion<std::optional<Estimate>> result;
    for (const RegionInfo& info : kRegions) {
        std::vector<double> values;
        for (const Json* row : rows) {
            const Json regions = row->at("metrics").value("regions", Json::object());
            const Json value =
                regions.value(std::string(info.name), Json::object()).value(key, Json());
            if (value.is_number()) values.push_back(value.get<double>());
        }
        if (!values.empty() && values.size() == rows.size())
            result[region_index(info.region)] = estimate_db(values);
    }
    return result;
}

/// A mean of squared display values in the decibels of psnr_float_db. None at or below 0, as an
/// unbiased estimate of a small one may be.
std::optional<Estimate> error_db(const std::optional<double>& mean,
                                 const std::vector<double>& by_seed) {
    if (!mean || !(*mean > 0)) return std::nullopt;
    const auto to_db = [](double value) { return -10.0 * std::log10(value); };
    Estimate result{to_db(*mean), {}, {}};
    if (by_seed.size() < 2) return result;
    const Estimate linear = estimate(by_seed);
    if (*linear.low > 0) result.high = to_db(*linear.low);
    result.low = to_db(*linear.high);
    return result;
}

GroupSummary summarise_group(const std::vector<const Json*>& all) {
    const Json& first = *all.front();
    GroupSummary group;
    group.group = first["group"];
    group.scene = first["scene"];
    group.method = first["method"];
    group.params = first["params"];
    group.against = first.value("against", "");
    group.samples_ratio = first.value("samples_ratio", 0.0);
    std::vector<const Json*> rows;
    for (const Json* row : all) {
        group.cells.push_back((*row)["cell"]);
        if ((*row)["status"] != "ok") continue;
        rows.push_back(row);
        group.seeds_done.push_back(row->value("seed", std::uint32_t{0}));
        group.dropped_samples += row->at("counts").value("dropped_samples", std::size_t{0});
    }
    group.seeds = rows.size();
    group.failed = all.size() - rows.size();
    if (rows.empty()) return group;
    group.psnr_float_db = metric(rows, "psnr_float_db", estimate_db);
    group.psnr_db = metric(rows, "psnr_db", estimate_db);
    group.ssim = metric(rows, "ssim", estimate);
    group.relmse = metric(rows, "relmse", estimate);
    group.region_psnr_float_db = region_metric(rows, "psnr_float_db");
    group.times_s = values_of(rows, "time_s", "total");
    group.time_s = median(group.times_s);
    group.reconstruct_s = median(values_of(rows, "time_s", "reconstruct"));
    if (const auto traced = values_of(rows, "time_s", "trace"); !traced.empty())
        group.trace_s = median(traced);
    group.fallback_pixels = rows.front()->at("counts").value("fallback_pixels", std::size_t{0});
    return group;
}

void set_time_shares(std::vector<GroupSummary>& groups) {
    for (GroupSummary& group : groups) {
        const auto path = std::ranges::find(groups, group.against, &GroupSummary::group);
        if (path != groups.end() && path->time_s > 0)
            group.time_share = group.time_s / path->time_s;
    }
}

void set_statistics(GroupSummary& group, const StatisticsByGroup& statistics) {
    const auto found = statistics.find(group.group);
    if (found == statistics.end()) return;
    group.statistics = found->second;
    const SeedStatistics& whole = found->second.whole;
    group.noise_db = error_db(whole.noise, whole.noise_by_seed);
    group.bias_db = error_db(whole.bias2, whole.bias2_by_seed);
}

std::string cell_text(const std::optional<Estimate>& e, int digits) {
    if (!e) return "-";
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, e->mean);
    return text;
}

/// 0 stands for a time that is not known.
std::string time_text(double value, int digits, const char* unit) {
    if (!(value > 0)) return "-";
    char text[64];
    std::snprintf(text, sizeof text, "%.*f%s", digits, value, unit);
    return text;
}

std::string interval_text(const std::optional<Estimate>& e) {
    if (!e || !e->low || !e->high) return "";
    char text[64];
    std::snprintf(text, sizeof text, "+-%.2f", 0.5 * (*e->high - *e->low));
    return text;
}

}  // namespace

const SeedStatistics* GroupSummary::statistics_of(const std::string& region) const {
    if (!statistics) return nullptr;
    if (region.empty()) return &statistics->whole;
    if (!statistics->regions) return nullptr;
    const auto* const info = std::ranges::find(kRegions, region, &RegionInfo::name);
    return info == kRegions.end() ? nullptr : &(*statistics->regions)[region_index(info->region)];
}

Json estimate_json(const std::optional<Estimate>& e) {
    if (!e) return nullptr;
    return {{"mean", e->mean},
            {"low", e->low ? Json(*e->low) : Json(nullptr)},
            {"high", e->high ? Json(*e->high) : Json(nullptr)}};
}

std::vector<GroupSummary> summarise(const std::vector<Json>& rows,
                                    const StatisticsByGroup& statistics) {
    std::vector<std::string> order;
    std::map<std::string, std::vector<const Json*>> by_group;
    for (const Json& row : rows) {
        auto& members = by_group[row["group"].get<std::string>()];
        if (members.empty()) order.push_back(row["group"]);
        members.push_back(&row);
    }
    std::vector<GroupSummary> groups;
    for (const std::string& name : order) groups.push_back(summarise_group(by_group[name]));
    set_time_shares(groups);
    for (GroupSummary& group : groups) set_statistics(group, statistics);
    return groups;
}

Json summary_json(const GroupSummary& g) {
    Json regions;
    for (const RegionInfo& info : kRegions) {
        const auto& value = g.region_psnr_float_db[region_index(info.region)];
        regions[std::string(info.name)] = estimate_json(value);
    }
    return {{"regions", regions},
            {"noise_db", estimate_json(g.noise_db)},
            {"bias_db", estimate_json(g.bias_db)},
            {"group", g.group},
            {"scene", g.scene},
            {"method", g.method},
            {"params", g.params},
            {"seeds", g.seeds},
            {"failed", g.failed},
            {"psnr_float_db", estimate_json(g.psnr_float_db)},
            {"psnr_db", estimate_json(g.psnr_db)},
            {"ssim", estimate_json(g.ssim)},
            {"relmse", estimate_json(g.relmse)},
            {"time_s", g.time_s},
            {"reconstruct_s", g.reconstruct_s},
            {"time_share", g.time_share},
            {"samples_ratio", g.samples_ratio},
            {"fallback_pixels", g.fallback_pixels},
            {"cells", g.cells}};
}

std::string summary_table(const std::vector<GroupSummary>& groups) {
    std::size_t width = 4;
    for (const GroupSummary& g : groups) width = std::max(width, g.group.size());
    // Names may be of any length: only the numbers go through the fixed-size line.
    const auto padded = [&](std::string name) {
        name.resize(width, ' ');
        return name;
    };
    char line[128];
    std::snprintf(line, sizeof line, "  %8s %6s  %8s  %7s  %9s  %9s  %7s\n", "psnr dB", "",
                  "interior", "ssim", "relmse", "time s", "share");
    std::string table = padded("cell") + line;
    for (const GroupSummary& g : groups) {
        const auto& interior = g.region_psnr_float_db[region_index(Region::interior)];
        std::snprintf(line, sizeof line, "  %8s %6s  %8s  %7s  %9s  %9s  %7s\n",
                      cell_text(g.psnr_float_db, 2).c_str(), interval_text(g.psnr_float_db).c_str(),
                      cell_text(interior, 2).c_str(), cell_text(g.ssim, 4).c_str(),
                      cell_text(g.relmse, 6).c_str(), time_text(g.time_s, 4, "").c_str(),
                      time_text(100.0 * g.time_share, 2, "%").c_str());
        table += padded(g.group) + line;
    }
    return table;
}

}  // namespace vecino
