// SPDX-License-Identifier: Apache-2.0
#include "eval/summary.h"

#include <algorithm>
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

GroupSummary summarise_group(const std::vector<const Json*>& all) {
    const Json& first = *all.front();
    GroupSummary group;
    group.group = first["group"];
    group.scene = first["scene"];
    group.method = first["method"];
    group.params = first["params"];
    group.samples_ratio = first.value("samples_ratio", 0.0);
    std::vector<const Json*> rows;
    for (const Json* row : all) {
        group.cells.push_back((*row)["cell"]);
        if ((*row)["status"] == "ok") rows.push_back(row);
    }
    group.seeds = rows.size();
    group.failed = all.size() - rows.size();
    if (rows.empty()) return group;
    group.psnr_float_db = metric(rows, "psnr_float_db", estimate_db);
    group.psnr_db = metric(rows, "psnr_db", estimate_db);
    group.ssim = metric(rows, "ssim", estimate);
    group.relmse = metric(rows, "relmse", estimate);
    group.time_s = median(values_of(rows, "time_s", "total"));
    group.reconstruct_s = median(values_of(rows, "time_s", "reconstruct"));
    group.fallback_pixels = rows.front()->at("counts").value("fallback_pixels", std::size_t{0});
    return group;
}

void set_time_shares(std::vector<GroupSummary>& groups) {
    for (GroupSummary& group : groups) {
        const auto path = std::ranges::find_if(groups, [&](const GroupSummary& other) {
            return other.method == "path" && other.scene == group.scene && other.time_s > 0;
        });
        if (path != groups.end()) group.time_share = group.time_s / path->time_s;
    }
}

Json estimate_json(const std::optional<Estimate>& e) {
    if (!e) return nullptr;
    return {{"mean", e->mean},
            {"low", e->low ? Json(*e->low) : Json(nullptr)},
            {"high", e->high ? Json(*e->high) : Json(nullptr)}};
}

std::string cell_text(const std::optional<Estimate>& e, int digits) {
    if (!e) return "-";
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, e->mean);
    return text;
}

std::string interval_text(const std::optional<Estimate>& e) {
    if (!e || !e->low || !e->high) return "";
    char text[64];
    std::snprintf(text, sizeof text, "+-%.2f", 0.5 * (*e->high - *e->low));
    return text;
}

}  // namespace

std::vector<GroupSummary> summarise(const std::vector<Json>& rows) {
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
    return groups;
}

Json summary_json(const GroupSummary& g) {
    return {{"group", g.group},
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
    std::snprintf(line, sizeof line, "  %8s %6s  %7s  %9s  %9s  %7s\n", "psnr dB", "", "ssim",
                  "relmse", "time s", "share");
    std::string table = padded("cell") + line;
    for (const GroupSummary& g : groups) {
        std::snprintf(line, sizeof line, "  %8s %6s  %7s  %9s  %9.4f  %6.2f%%\n",
                      cell_text(g.psnr_float_db, 2).c_str(), interval_text(g.psnr_float_db).c_str(),
                      cell_text(g.ssim, 4).c_str(), cell_text(g.relmse, 6).c_str(), g.time_s,
                      100.0 * g.time_share);
        table += padded(g.group) + line;
    }
    return table;
}

}  // namespace vecino
