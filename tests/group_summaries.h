// SPDX-License-Identifier: Apache-2.0
//
// Results of a run and claims about them, made by hand: what verdicts are decided by.
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/reproduction.h"

namespace vecino {

using Groups = std::vector<GroupSummary>;

/// Errors of four seeds that are dB above others made so, seed by seed: their ratio has an interval
/// of no width.
inline std::vector<double> errors_db(double db) {
    std::vector<double> errors{1e-3, 2e-3, 3e-3, 4e-3};
    for (double& error : errors) error *= std::pow(10.0, 0.1 * db);
    return errors;
}

/// The same mean, in another order of seeds: no pair of these is sure to differ from errors_db(db)
/// by less than 3.19 dB to either side.
inline std::vector<double> unsure_errors_db(double db) {
    const auto errors = errors_db(db);
    return {errors[1], errors[0], errors[3], errors[2]};
}

inline SeedStatistics statistics_of(const std::vector<double>& mse) {
    SeedStatistics statistics;
    statistics.pixels = 64;
    statistics.mse = mse;
    statistics.noise_by_seed = mse;
    return statistics;
}

/// Parameters as a run gives them to a cell; what is null in more is not there.
inline nlohmann::json params_of(const std::string& method, const nlohmann::json& more) {
    nlohmann::json params = {{"scene", "scenes/box.json"},
                             {"method", method},
                             {"spp", 100},
                             {"spp_asked", 100},
                             {"size", {8, 8}},
                             {"light_sampling", "none"},
                             {"seed", 1},
                             {"budget", "same_spp"}};
    if (method != "path") params["reduction"] = 2;
    if (method != "path" && method != "nearest") params["window"] = 3;
    params.update(more);
    return params;
}

/// A group of finished cells, one per error, named by its scene, its method and more.
inline GroupSummary group_of(const std::string& method, const nlohmann::json& more,
                             const std::vector<double>& mse) {
    GroupSummary group;
    group.params = params_of(method, more);
    group.method = method;
    group.scene = selected_value(group.params, "scene");
    group.group = group.scene + "." + method;
    for (const auto& [key, value] : more.items())
        if (key != "scene") group.group += "." + key + value.dump();
    group.seeds = mse.size();
    for (std::uint32_t seed = 1; seed <= mse.size(); ++seed) {
        group.seeds_done.push_back(seed);
        group.times_s.push_back(1.0);
    }
    group.time_s = 1.0;
    group.statistics = SeedStatisticsByRegion{statistics_of(mse), {}};
    return group;
}

/// A group whose seeds took the given times.
inline GroupSummary timed_group(const std::string& method, const nlohmann::json& more,
                                const std::vector<double>& times_s) {
    GroupSummary group = group_of(method, more, std::vector<double>(times_s.size(), 1e-3));
    group.times_s = times_s;
    group.time_s = 0;
    for (const double time : times_s) group.time_s += time / static_cast<double>(times_s.size());
    return group;
}

/// A matrix with a reproduction, as small as it may be; parts replace its own.
inline nlohmann::json reproduction_matrix(const nlohmann::json& parts) {
    const nlohmann::json variant = {{"id", "printed"}, {"label", "as printed"}};
    nlohmann::json reproduction = {{"source", "a book"},
                                   {"variants", nlohmann::json::array({variant})}};
    reproduction.update(parts);
    return {{"axes", {{"scene", "box.json"}, {"scheme", "mean"}}}, {"reproduction", reproduction}};
}

inline Reproduction read_parts(const nlohmann::json& parts) {
    const nlohmann::json matrix = reproduction_matrix(parts);
    return read_reproduction(JsonValue(matrix, "matrix.json"));
}

/// Of one test or an array of several.
inline nlohmann::json claim_json(const nlohmann::json& tests, bool any = false) {
    const nlohmann::json list = tests.is_array() ? tests : nlohmann::json::array({tests});
    return {{"id", "c"}, {"section", "1"}, {"text", "it is so"}, {"tests", list}, {"any", any}};
}

/// Every variant, whole and interior, of one claim.
inline std::vector<ClaimResult> judge_all(const nlohmann::json& claim, const Groups& groups,
                                          nlohmann::json parts = nlohmann::json::object()) {
    parts["claims"] = nlohmann::json::array({claim});
    return evaluate(read_parts(parts), groups).claims.at(0);
}

/// The whole image in the first variant.
inline ClaimResult judge(const nlohmann::json& claim, const Groups& groups) {
    return judge_all(claim, groups).at(0);
}

}  // namespace vecino
