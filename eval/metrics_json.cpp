// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics_json.h"

#include <algorithm>
#include <functional>

namespace vecino {

nlohmann::json metrics_json(const Metrics& metrics) {
    nlohmann::json json;
    for (const MetricInfo& metric : all_metrics()) {
        const std::string name(metric.name);
        const auto value = metric.value(metrics);
        if (!value && metric.is_on_request) continue;
        json[name] = value ? nlohmann::json(*value) : nlohmann::json(nullptr);
        if (metric.reason && !metric.reason(metrics).empty())
            json[name + "_reason"] = metric.reason(metrics);
    }
    json["identical_8bit"] = metrics.identical_8bit;
    return json;
}

nlohmann::json metrics_json(const std::optional<Metrics>& metrics) {
    if (metrics) return metrics_json(*metrics);
    nlohmann::json json{{"identical_8bit", false}};
    for (const MetricInfo& metric : all_metrics())
        if (!metric.is_on_request) json[std::string(metric.name)] = nullptr;
    return json;
}

nlohmann::json comparison_json(const Comparison& comparison) {
    nlohmann::json json = metrics_json(comparison.metrics);
    const NonFinite& found = comparison.non_finite;
    json["non_finite"] = {{"count", found.count}, {"first", nullptr}};
    if (found.count > 0) json["non_finite"]["first"] = {found.x, found.y, found.channel};
    if (!comparison.regions) return json;
    for (const RegionInfo& info : kRegions) {
        const RegionMetrics& region = (*comparison.regions)[region_index(info.region)];
        nlohmann::json& entry = json["regions"][std::string(info.name)];
        entry = metrics_json(region.metrics);
        entry["pixels"] = region.pixels;
    }
    return json;
}

Image difference(const Image& test, const Image& reference) {
    Image result(test.size());
    std::ranges::transform(test.values(), reference.values(), result.values().begin(),
                           std::minus{});
    return result;
}

std::string size_mismatch_text(const std::string& a, Extent a_size, const std::string& b,
                               Extent b_size) {
    return a + " is " + size_text(a_size) + ", " + b + " is " + size_text(b_size) +
           ": allowed: equal sizes";
}

}  // namespace vecino
