// SPDX-License-Identifier: Apache-2.0
//
// Rows of results.jsonl, made by hand for what summaries and reports say about them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace vecino {

/// A finished cell of scene "box": group "box.METHOD", named by its seed.
inline nlohmann::json result_row(const std::string& method, int seed) {
    const std::string group = "box." + method;
    return {
        {"cell", group + ".s" + std::to_string(seed)},
        {"group", group},
        {"against", "box.path"},
        {"scene", "box"},
        {"method", method},
        {"seed", seed},
        {"params", {{"scene", "box.json"}, {"method", method}, {"reduction", 1}}},
        {"samples_ratio", 1.0},
        {"status", "ok"},
        {"metrics", {{"psnr_float_db", 20.0}, {"psnr_db", 20.0}, {"ssim", 0.5}, {"relmse", 0.1}}},
        {"time_s", {{"reconstruct", 0.1}, {"total", 1.0}}},
        {"counts", {{"fallback_pixels", 0}}}};
}

/// The same cell, failed before anything was measured.
inline nlohmann::json failed_row(const std::string& method, int seed, const std::string& reason) {
    nlohmann::json row = result_row(method, seed);
    for (const char* key : {"metrics", "time_s", "counts"}) row.erase(key);
    row["status"] = "failed";
    row["reason"] = reason;
    return row;
}

}  // namespace vecino
