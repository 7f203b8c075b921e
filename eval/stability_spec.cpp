// SPDX-License-Identifier: Apache-2.0
#include "eval/stability_spec.h"

#include "core/json_schema.h"

namespace vecino {
namespace {

using enum Presence;

constexpr RealKind kShift{{0.001, 1000.0}};
constexpr BooleanKind kBoolean{};

void read_shifts(StabilitySpec& spec, const JsonValue& json) {
    spec.shifts.clear();
    for (const JsonValue& shift : json.elements()) {
        const float value = kShift.read(shift);
        if (!spec.shifts.empty() && value <= spec.shifts.back())
            shift.fail("more than the one before");
        spec.shifts.push_back(value);
    }
}

constexpr JsonKey<StabilitySpec> kKeys[] = {
    {"shifts", optional,
     "of the camera, right and down alike, in pixels of the full resolution; default 0.25 and 0.5",
     read_shifts,
     [] {
         return array_schema(kShift.schema(), {0, 0});
     }},
    member_key<kBoolean, &StabilitySpec::elasticity>(
        "elasticity", optional, "vary every numeric parameter by half of it; default true"),
};

}  // namespace

StabilitySpec read_stability(const JsonValue& json) {
    StabilitySpec spec;
    read_object(json, kKeys, spec);
    return spec;
}

nlohmann::json stability_schema() {
    return object_schema(kKeys);
}

}  // namespace vecino
