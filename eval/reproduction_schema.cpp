// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <string>
#include <vector>

#include "core/json_schema.h"
#include "eval/axes.h"
#include "eval/matrix_schema.h"
#include "eval/regions.h"
#include "filters/methods.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

using nlohmann::json;
using enum Presence;

constexpr TextKind kText{};
constexpr BooleanKind kSwitch{};
constexpr RealKind kPositive{{1e-9, 1e12}};
constexpr RealKind kMargin{{0.0, 100.0}};
constexpr IntegerKind kSpp{1, std::numeric_limits<int>::max()};

/// One of the methods that results have.
json method_schema() {
    json schema{{"enum", {"blocky_ceiling"}}};
    for (const Method& method : all_methods()) schema["enum"].push_back(method.name);
    for (const Scheme& scheme : all_schemes()) schema["enum"].push_back(scheme.name);
    return schema;
}

/// Said once, at times_at, and named elsewhere.
json selection_schema() {
    json schema{{"type", "object"}, {"additionalProperties", false}};
    for (const std::string_view name : cell_keys()) {
        if (name == "scheme" || name == "image") continue;  // "method" names these
        const std::string key(name);
        schema["properties"][key] = {{"$ref", "#/properties/axes/properties/" + key}};
    }
    const json method = method_schema();
    schema["properties"]["method"] = {{"anyOf", {method, array_schema(method, {1, 0})}}};
    return schema;
}

json selection() {
    return {{"$ref", "#/properties/reproduction/properties/times_at"}};
}

json selections() {
    return {{"anyOf", {selection(), array_schema(selection(), {0, 0})}}};
}

json regions_schema() {
    json region;
    for (const RegionInfo& info : kRegions) region["enum"].push_back(info.name);
    return array_schema(region, {2, 2});
}

constexpr DescribedKey kVariantKeys[] = {
    {"id", required, "", schema_of<kText>},
    {"label", required, "shown in the report", schema_of<kText>},
    {"where", optional, "the results that it is about", selection},
    {"tested_at", optional,
     "what differs in the results, of several seeds, that decide claims and shares", selection},
};

constexpr DescribedKey kItemKeys[] = {
    {"id", required, "", schema_of<kText>},
    {"section", required, "of the publication", schema_of<kText>},
    {"text", required, "what is stated", schema_of<kText>},
    {"note", optional, "how the words were turned into a number", schema_of<kText>},
    {"published", required, "the number, in its unit", schema_of<kPositive>},
    {"unit", required, "",
     [] {
         return json{{"enum", {"%", "min", "h"}}};
     }},
    {"quantity", required, "of the slowest result",
     [] {
         return json{{"enum", {"time", "largest_time_share", "extrapolated_time"}}};
     }},
    {"of", required, "the results", selection},
    {"within", optional, "points by which a share may differ", schema_of<kPositive>},
    {"spp", optional, "of an extrapolated time", schema_of<kSpp>},
};

constexpr DescribedKey kTestKeys[] = {
    {"quantity", required, "",
     [] {
         return json{{"enum", {"quality", "noise", "signature"}}};
     }},
    {"of", required, "the results", selection},
    {"is", required, "",
     [] {
         return json{{"enum", {"higher", "lower", "same"}}};
     }},
    {"than", required, "the results that they are held against", selection},
    {"margin_db", optional, "by more than this; \"same\": within it", schema_of<kMargin>},
    {"regions", optional, "of the image: of \"of\" and of \"than\"", regions_schema},
};

constexpr DescribedKey kClaimKeys[] = {
    {"id", required, "", schema_of<kText>},
    {"section", required, "of the publication", schema_of<kText>},
    {"text", required, "what is claimed", schema_of<kText>},
    {"note", optional, "how the words were turned into numbers", schema_of<kText>},
    {"tests", required, "",
     [] {
         return array_schema(object_schema(kTestKeys), {1, 0});
     }},
    {"any", optional, "whether one pair of results per scene is enough", schema_of<kSwitch>},
};

constexpr DescribedKey kGraphKeys[] = {
    {"id", required, "", schema_of<kText>},
    {"title", required, "", schema_of<kText>},
    {"of", required, "the results", selection},
};

constexpr DescribedKey kFigureKeys[] = {
    {"id", required, "", schema_of<kText>},
    {"title", required, "", schema_of<kText>},
    {"kind", optional, "default: mosaic",
     [] {
         return json{{"enum", {"mosaic", "reference", "light", "strips"}}};
     }},
    {"of", optional, "the results, one after the other", selections},
};

template <const auto& kKeys>
json rows() {
    return array_schema(object_schema(kKeys), {0, 0});
}

constexpr DescribedKey kReproductionKeys[] = {
    // Both required of a matrix that extends none: matrix_schema.cpp.
    {"source", optional, "what is reproduced", schema_of<kText>},
    {"variants", optional, "ways to run the same claims; the first is as published",
     [] {
         return array_schema(object_schema(kVariantKeys), {1, 0});
     }},
    {"times_at", optional, "where published times (not shares) mean anything", selection_schema},
    {"items", optional, "numbers that are stated", rows<kItemKeys>},
    {"claims", optional, "what is stated of results against each other", rows<kClaimKeys>},
    {"graphs", optional, "", rows<kGraphKeys>},
    {"figures", optional, "", rows<kFigureKeys>},
};

}  // namespace

json reproduction_schema() {
    return object_schema(kReproductionKeys);
}

}  // namespace vecino
