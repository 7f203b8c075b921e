// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics_json.h"

#include <algorithm>
#include <functional>

namespace vecino {

nlohmann::json metrics_json(const Metrics& metrics) {
    nlohmann::json json;
    for (const MetricInfo& metric : all_metrics()) {
        const auto value = metric.value(metrics);
        json[std::string(metric.name)] = value ? nlohmann::json(*value) : nlohmann::json(nullptr);
    }
    json["identical_8bit"] = metrics.identical_8bit;
    if (!metrics.ssim_reason.empty()) json["ssim_reason"] = metrics.ssim_reason;
    return json;
}

nlohmann::json comparison_json(const Comparison& comparison) {
    nlohmann::json json;
    if (comparison.metrics) {
        json = metrics_json(*comparison.metrics);
    } else {
        for (const MetricInfo& metric : all_metrics()) json[std::string(metric.name)] = nullptr;
        json["identical_8bit"] = false;
    }
    const NonFinite& found = comparison.non_finite;
    json["non_finite"] = {{"count", found.count}, {"first", nullptr}};
    if (found.count > 0) json["non_finite"]["first"] = {found.x, found.y, found.channel};
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
