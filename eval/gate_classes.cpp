// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_classes.h"

#include <algorithm>
#include <map>

#include "core/json_schema.h"
#include "eval/matrix_schema.h"

namespace vecino {
namespace {

using Json = nlohmann::json;
using enum Presence;

constexpr const char* kDefaultClass = "default";
constexpr std::pair<const char*, double> kDefaultTolerances_db[] = {
    {"psnr_float_db", 0.1},
    {"edge.psnr_float_db", 0.2},
    {"worst_tile_psnr_db", 0.5},
    {"p99_error", 0.5},
};

constexpr TextKind kText{};
constexpr NumberRange kTolerance{0.0, 100.0};
constexpr NumberRange kSigmas{0.0, 8.0};
constexpr NumberRange kPercent{0.0, 1000.0};
constexpr RealKind kToleranceKind{kTolerance};
constexpr RealKind kSigmasKind{kSigmas};
constexpr BooleanKind kSwitch{};
constexpr RealKind kPercentKind{kPercent};

std::string metric_names() {
    std::string names;
    for (const GateMetric& metric : all_gate_metrics())
        names += (names.empty() ? "" : ", ") + metric.name;
    return names;
}

void read_name(GateClass& gate, const JsonValue& json) {
    gate.name = json.string();
    if (gate.name.empty() || gate.name == kDefaultClass)
        json.fail("a name of its own; \"default\" is what no class names");
}

void read_where(GateClass& gate, const JsonValue& json) {
    gate.where = Selection::read(json);
}

/// One number is the tolerance of each metric that is judged by default.
void read_tolerances(GateClass& gate, const JsonValue& json) {
    if (json.raw().is_number()) {
        for (auto& [metric, tolerance] : gate.tolerance_db) tolerance = json.number(kTolerance);
        return;
    }
    gate.tolerance_db.clear();
    for (const auto& [name, value] : json.members()) {
        auto metric = find_gate_metric(name);
        if (!metric) json.fail("\"" + name + "\"", metric_names());
        gate.tolerance_db.emplace_back(std::move(*metric), value.number(kTolerance));
    }
}

void read_sigmas(GateClass& gate, const JsonValue& json) {
    gate.k_sigma = json.number(kSigmas);
}

void read_time_tolerance(GateClass& gate, const JsonValue& json) {
    gate.time_tolerance = json.number(kPercent) / 100;
}

/// Where a selection is described: at the reproduction's first use of one.
Json selection_schema() {
    return {{"$ref", "#/properties/reproduction/properties/times_at"}};
}

Json tolerances_schema() {
    Json by_metric{{"type", "object"}, {"additionalProperties", false}};
    for (const GateMetric& metric : all_gate_metrics())
        by_metric["properties"][metric.name] = kToleranceKind.schema();
    return {{"anyOf", {kToleranceKind.schema(), by_metric}}};
}

constexpr JsonKey<GateClass> kKeys[] = {
    {"class", required, "its name in verdicts", read_name, schema_of<kText>},
    {"where", optional, "the cells that are of it, unless an earlier class has them", read_where,
     selection_schema},
    {"tolerance_db", optional,
     "how many dB an error may grow beyond what noise explains: by metric, or one number for those "
     "that are judged by default",
     read_tolerances, tolerances_schema},
    {"k_sigma", optional, "how far noise may reach; 3 by default", read_sigmas,
     schema_of<kSigmasKind>},
    member_key<kSwitch, &GateClass::either_way>(
        "either_way", optional,
        "whether an error may not fall either: of methods that are specified to the letter"),
    {"time_tolerance_percent", optional,
     "how much longer it may take; time is not gated without it", read_time_tolerance,
     schema_of<kPercentKind>},
};

}  // namespace

GateClass default_gate_class() {
    GateClass gate;
    gate.name = kDefaultClass;
    for (const auto& [name, tolerance] : kDefaultTolerances_db)
        gate.tolerance_db.emplace_back(find_gate_metric(name).value(), tolerance);
    return gate;
}

std::vector<GateClass> read_gate_classes(const JsonValue& matrix) {
    std::vector<GateClass> classes;
    if (matrix.has("gates")) {
        for (const JsonValue& json : matrix.at("gates").elements()) {
            GateClass gate = default_gate_class();
            read_object(json, kKeys, gate);
            if (std::ranges::find(classes, gate.name, &GateClass::name) != classes.end())
                json.at("class").fail("a name that no other class has");
            classes.push_back(std::move(gate));
        }
    }
    classes.push_back(default_gate_class());
    return classes;
}

const GateClass& class_of(const std::vector<GateClass>& classes, const Json& params) {
    const auto found = std::ranges::find_if(
        classes, [&](const GateClass& gate) { return gate.where.matches(params); });
    return found == classes.end() ? classes.back() : *found;
}

nlohmann::json gates_schema() {
    return array_schema(object_schema(kKeys), {0, 0});
}

}  // namespace vecino
