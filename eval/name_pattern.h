// SPDX-License-Identifier: Apache-2.0
//
// --only: cells by their names.
#pragma once

#include <regex>
#include <string>

namespace vecino {

/// A regular expression that a name must hold somewhere; the empty one is in every name.
class NamePattern {
  public:
    /// Throws Error(usage) if it is no ECMAScript regular expression.
    explicit NamePattern(const std::string& only);

    [[nodiscard]] bool matches(const std::string& name) const {
        return std::regex_search(name, pattern_);
    }
    /// What to throw where it matches nothing.
    [[noreturn]] void fail_without_match() const;

  private:
    std::string text_;
    std::regex pattern_;
};

}  // namespace vecino
