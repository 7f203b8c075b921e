// SPDX-License-Identifier: Apache-2.0
#include "eval/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/timing.h"
#include "eval/metrics.h"
#include "eval/reference_error.h"

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
    Estimate result{decibels_of(*mean), {}, {}};
    if (by_seed.size() < 2) return result;
    const Estimate linear = estimate(by_seed);
    if (*linear.low > 0) result.high = decibels_of(*linear.low);
    if (*linear.high > 0) result.low = decibels_of(*linear.high);
    return result;
}

/// With an interval where there are enough seeds for one.
std::optional<Estimate> mean_of(const std::optional<double>& mean,
                                const std::vector<double>& by_seed) {
    if (!mean) return std::nullopt;
    return by_seed.size() < 2 ? Estimate{*mean, {}, {}} : estimate(by_seed);
}

std::map<std::string, Estimate> all_metrics_of(const std::vector<const Json*>& rows) {
    std::map<std::string, Estimate> metrics;
    for (const MetricInfo& info : all_metrics()) {
        const std::string name(info.name);
        const auto estimator = info.scale == ErrorScale::decibel ? estimate_db : estimate;
        if (const auto found = metric(rows, name.c_str(), estimator)) metrics.emplace(name, *found);
    }
    return metrics;
}

Json mean_json(const std::optional<Estimate>& value) {
    return value ? Json(value->mean) : Json();
}

/// Of the means over seeds. A group whose every image equals its reference has no decibels.
void set_limits(GroupSummary& group, const Json& error) {
    const bool is_known = error.is_object() && error.value("psnr_float_db", Json()).is_number();
    if (is_known) group.reference_db = error["psnr_float_db"].get<double>();
    if (error.is_object() && error.value("relmse", Json()).is_number())
        group.reference_relmse = error["relmse"].get<double>();
    const Json whole{{"psnr_float_db", mean_json(group.psnr_float_db)},
                     {"relmse", mean_json(group.relmse)}};
    group.is_limited = limited_by_reference(whole, error);
    for (const RegionInfo& info : kRegions) {
        const std::size_t i = region_index(info.region);
        const Json part{{"psnr_float_db", mean_json(group.region_psnr_float_db[i])}};
        group.region_is_limited[i] =
            limited_by_reference(part, part_of_error(error, std::string(info.name)));
    }
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
    group.metrics = all_metrics_of(rows);
    group.region_psnr_float_db = region_metric(rows, "psnr_float_db");
    set_limits(group, rows.front()->value("reference_error", Json()));
    if (const auto predicted = values_of(rows, "facts", "predicted_psnr_float_db");
        !predicted.empty()) {
        group.predicted_db = median(predicted);
    }
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
    const double own = group.reference_db ? mse_of(*group.reference_db) : 0.0;
    const ErrorSplit display = whole.without_reference(own);
    group.noise_db = error_db(display.noise, display.noise_by_seed);
    group.bias_db = error_db(display.bias2, display.bias2_by_seed);
    const ErrorSplit relative = whole.relative.without_reference(group.reference_relmse);
    group.relmse_noise = mean_of(relative.noise, relative.noise_by_seed);
    group.relmse_bias = mean_of(relative.bias2, relative.bias2_by_seed);
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

namespace {

Json flag_json(const std::optional<bool>& flag) {
    return flag ? Json(*flag) : Json();
}

Json metrics_json(const GroupSummary& g) {
    Json metrics = Json::object();
    for (const auto& [name, value] : g.metrics) metrics[name] = estimate_json(value);
    return metrics;
}

Json limited_regions_json(const GroupSummary& g) {
    Json regions;
    for (const RegionInfo& info : kRegions)
        regions[std::string(info.name)] = flag_json(g.region_is_limited[region_index(info.region)]);
    return regions;
}

/// What the columns and the mark mean, where a table has them.
std::string table_notes(const std::vector<GroupSummary>& groups) {
    std::string notes;
    if (std::ranges::any_of(groups, [](const GroupSummary& g) { return g.noise_db.has_value(); })) {
        for (std::size_t i = 0; i < 2; ++i)
            notes += std::string(kSplitColumns[i].name) + ": " +
                     std::string(kSplitColumns[i].formula) + "\n";
    }
    if (std::ranges::any_of(groups, [](const GroupSummary& g) { return g.is_limited == true; }))
        notes += "* " + std::string(kLimitedFormula) + "\n";
    return notes;
}

}  // namespace

Json summary_json(const GroupSummary& g) {
    Json regions;
    for (const RegionInfo& info : kRegions) {
        const auto& value = g.region_psnr_float_db[region_index(info.region)];
        regions[std::string(info.name)] = estimate_json(value);
    }
    Json json{{"regions", regions},
              {"metrics", metrics_json(g)},
              {"noise_db", estimate_json(g.noise_db)},
              {"bias_db", estimate_json(g.bias_db)},
              {"relmse_noise", estimate_json(g.relmse_noise)},
              {"relmse_bias", estimate_json(g.relmse_bias)},
              {"reference_db", g.reference_db ? Json(*g.reference_db) : Json()},
              {"predicted_psnr_float_db", g.predicted_db ? Json(*g.predicted_db) : Json()},
              {"limited_by_reference", flag_json(g.is_limited)},
              {"limited_regions", limited_regions_json(g)},
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
    if (g.stability) json["stability"] = group_stability_json(*g.stability);
    return json;
}

std::string summary_table(const std::vector<GroupSummary>& groups) {
    std::size_t width = 4;
    for (const GroupSummary& g : groups) width = std::max(width, g.group.size());
    // Names may be of any length: only the numbers go through the fixed-size line.
    const auto padded = [&](std::string name) {
        name.resize(width, ' ');
        return name;
    };
    char line[160];
    std::snprintf(line, sizeof line, "  %8s  %6s  %8s  %7s  %7s  %7s  %9s  %9s  %7s\n", "psnr dB",
                  "", "interior", "noise", "bias", "ssim", "relmse", "time s", "share");
    std::string table = padded("cell") + line;
    for (const GroupSummary& g : groups) {
        const auto& interior = g.region_psnr_float_db[region_index(Region::interior)];
        std::snprintf(line, sizeof line, "  %8s%s %6s  %8s  %7s  %7s  %7s  %9s  %9s  %7s\n",
                      cell_text(g.psnr_float_db, 2).c_str(), g.is_limited == true ? "*" : " ",
                      interval_text(g.psnr_float_db).c_str(), cell_text(interior, 2).c_str(),
                      cell_text(g.noise_db, 2).c_str(), cell_text(g.bias_db, 2).c_str(),
                      cell_text(g.ssim, 4).c_str(), cell_text(g.relmse, 6).c_str(),
                      time_text(g.time_s, 4, "").c_str(),
                      time_text(100.0 * g.time_share, 2, "%").c_str());
        table += padded(g.group) + line;
    }
    return table + table_notes(groups);
}

}  // namespace vecino
