// SPDX-License-Identifier: Apache-2.0
//
// What the scenes of a matrix's failures need: settings that take the place of its axes and fixed
// values.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "eval/axes.h"
#include "eval/failure.h"

namespace vecino {

class FailureNeeds {
  public:
    /// Of a matrix's document and what was read of it; refers to the document.
    FailureNeeds(const JsonValue& matrix, const std::vector<FailureCase>& failures);

    /// The scenes of all failures, in their order.
    [[nodiscard]] const std::vector<JsonValue>& scenes() const { return scenes_; }

    /// Axes of one scene alone: several needed values are an axis; one value alone is moved to
    /// needed, for it is nothing to name a cell by.
    [[nodiscard]] Axes apply(Axes axes, const JsonValue& scene,
                             std::map<std::string, JsonValue>& needed) const;

    /// Into the frames of a scene, as the matrix names it.
    [[nodiscard]] std::vector<Injection> injections(const std::string& scene) const;

  private:
    std::vector<JsonValue> scenes_;
    std::map<std::string, Axes> needs_;
    std::map<std::string, std::vector<Injection>> injections_;
};

}  // namespace vecino
