// SPDX-License-Identifier: Apache-2.0
//
// Scenes that stand inside the program, so that a benchmark needs no file.
#pragma once

#include <string_view>

namespace vecino {

extern const std::string_view kCornellJson;
extern const std::string_view kCornellSphereJson;
extern const std::string_view kHardShadowsJson;
extern const std::string_view kCheckerSpheresJson;

}  // namespace vecino
