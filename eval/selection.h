// SPDX-License-Identifier: Apache-2.0
//
// Picks results by their parameters, in the words of a matrix: {"method": "mean", "window": [3,
// 5]}.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/json_read.h"

namespace vecino {

class Selection {
  public:
    /// Keys: "scene" (a name without folder and extension), "method" (a scheme's name, "path" or
    /// "blocky_ceiling"), "budget" and every option of renders and schemes; "spp" is what was asked
    /// for, before a budget. Each has one value or an array of allowed ones. Throws Error(usage).
    static Selection read(const JsonValue& json);

    /// Every named parameter is there and has one of the values.
    [[nodiscard]] bool matches(const nlohmann::json& params) const;
    /// Of what this one does not name, the parameters that are there have the values of `where`: an
    /// option that a scheme does not read fits every variant.
    [[nodiscard]] bool matches(const nlohmann::json& params, const Selection& where) const;

    [[nodiscard]] bool names(const std::string& key) const { return values_.contains(key); }
    /// The values at a key; none if it is not named.
    [[nodiscard]] std::vector<nlohmann::json> at(const std::string& key) const;
    /// The same without a key.
    [[nodiscard]] Selection without(const std::string& key) const;
    /// The keys that are there but have none of the values.
    [[nodiscard]] std::vector<std::string> mismatches(const nlohmann::json& params) const;
    /// Takes over another's values at keys that this one does not name.
    void add_missing(const Selection& other);
    /// "spp 1000, window 3 or 5"; empty where nothing is named.
    [[nodiscard]] std::string text() const;
    [[nodiscard]] bool empty() const { return values_.empty(); }

  private:
    std::map<std::string, std::vector<nlohmann::json>> values_;
};

/// A parameter of a result as a selection sees it; null if it is not there.
nlohmann::json selected_value(const nlohmann::json& params, const std::string& key);

}  // namespace vecino
