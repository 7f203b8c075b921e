// SPDX-License-Identifier: Apache-2.0
#include "eval/failure_needs.h"

namespace vecino {

FailureNeeds::FailureNeeds(const JsonValue& matrix, const std::vector<FailureCase>& failures) {
    if (!matrix.has("failures")) return;
    const auto documents = matrix.at("failures").elements();
    for (std::size_t i = 0; i < documents.size(); ++i) {
        const JsonValue scene = documents[i].at("scene");
        scenes_.push_back(scene);
        needs_.insert_or_assign(scene.string(), read_axes(documents[i].at("needs")));
        injections_.insert_or_assign(scene.string(), failures[i].inject);
    }
}

Axes FailureNeeds::apply(Axes axes, const JsonValue& scene,
                         std::map<std::string, JsonValue>& needed) const {
    axes["scene"] = {scene};
    needed.clear();
    const auto needs = needs_.find(scene.string());
    if (needs == needs_.end()) return axes;
    for (const auto& [key, values] : needs->second) {
        axes.erase(key);
        if (values.size() > 1) axes[key] = values;
        if (values.size() == 1) needed.insert_or_assign(key, values.front());
    }
    return axes;
}

std::vector<Injection> FailureNeeds::injections(const std::string& scene) const {
    const auto found = injections_.find(scene);
    return found == injections_.end() ? std::vector<Injection>() : found->second;
}

}  // namespace vecino
