// SPDX-License-Identifier: Apache-2.0
#include "eval/matrix_schema.h"

#include <string>

#include "core/json_schema.h"
#include "eval/axes.h"
#include "eval/budget.h"
#include "eval/image_source.h"
#include "eval/metrics.h"
#include "eval/render_options.h"
#include "eval/stability_spec.h"
#include "filters/methods.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

using nlohmann::json;
using enum Presence;

constexpr TextKind kText{};
constexpr IntegerKind kRepeat{1, 1000};

json scheme_schema() {
    json schema;
    for (const Scheme& scheme : all_schemes()) schema["enum"].push_back(scheme.name);
    return schema;
}

json method_schema() {
    json schema;
    for (const Method& method : all_methods()) schema["enum"].push_back(method.name);
    return schema;
}

json budget_schema() {
    return {{"enum", budget_names()}};
}

// What a cell is made of, beside the options of renders and schemes.
constexpr DescribedKey kCellKeys[] = {
    {"scene", optional, "a scene file, from the folder of the matrix", schema_of<kText>},
    {"scheme", optional, "how the large image is rebuilt", scheme_schema},
    {"method", optional, "a render in place of a scheme", method_schema},
    {"image", optional, "a key of images, in place of a scheme", schema_of<kText>},
    {"budget", optional, "how many samples a low-resolution frame gets", budget_schema},
};

/// The keys of a cell, each with one value.
json cell_schema() {
    json schema = object_schema(kCellKeys);
    const auto add = [&](const auto& row) {
        json& property = schema["properties"][std::string(row.name)] = row.schema();
        property["description"] = row.summary;
    };
    for (const RenderOption& row : render_options()) add(row);
    for (const SchemeOption& row : scheme_options()) add(row);
    for (const MethodOption& row : method_options()) add(row);
    return schema;
}

// Where the schemas of single values and of axes stand in the document: said once, then named.
const std::string kOneValue = "#/properties/fixed/properties/";
const std::string kAxes = "#/properties/axes";

/// The keys of a cell, each with one value or several.
json axes_schema() {
    json schema = cell_schema();
    for (const auto& [key, property] : schema["properties"].items()) {
        const json one{{"$ref", kOneValue + key}};
        property = {{"anyOf", {one, array_schema(one, {1, 0})}},
                    {"description", property["description"]}};
    }
    schema["not"] = {{"anyOf",
                      {{{"required", {"method", "scheme"}}},
                       {{"required", {"method", "image"}}},
                       {{"required", {"scheme", "image"}}}}}};
    return schema;
}

json patterns_schema() {
    return array_schema({{"$ref", kAxes}}, {0, 0});
}

json images_schema() {
    return {{"type", "object"}, {"additionalProperties", image_source_schema()}};
}

json reference_schema() {
    json schema{{"type", "object"}, {"additionalProperties", false}};
    schema["properties"]["file"] = {{"type", "string"}};
    schema["properties"]["channels"] = array_schema(kText.schema(), {3, 3});
    // A file has been rendered: it is told no options, and only it has channels of other names.
    json options;
    for (const char* key : {"spp", "light_sampling", "sampler", "seed"})
        options["anyOf"].push_back({{"required", {key}}});
    schema["dependencies"] = {{"channels", {"file"}}, {"file", {{"not", options}}}};
    for (const std::string key : {"spp", "light_sampling", "sampler", "seed"}) {
        schema["properties"][key] = {{"$ref", kOneValue + key}};
    }
    return schema;
}

/// Objects are what run.json keeps of the files (vecino schema failure).
json failures_schema() {
    return array_schema({{"type", {"string", "object"}}}, {1, 0});
}

json metrics_schema() {
    return array_schema({{"enum", metrics_on_request()}}, {0, 0});
}

constexpr DescribedKey kMeasureKeys[] = {
    {"repeat", optional, "timings of a short stage; the median counts", schema_of<kRepeat>},
    {"metrics", optional, "beside those that every cell has", metrics_schema},
};

constexpr DescribedKey kMatrixKeys[] = {
    {"$schema", optional, "the JSON Schema of matrices, for editors", schema_of<kText>},
    {"extends", optional, "a matrix that says what this one does not, from its folder",
     schema_of<kText>},
    {"name", required, "of the run", schema_of<kText>},
    {"axes", optional, "every combination of their values is a cell", axes_schema},
    {"exclude", optional, "cells that match one of these are left out", patterns_schema},
    {"include", optional, "cells beside those of the axes, whose values these replace",
     patterns_schema},
    {"fixed", optional, "values of every cell", cell_schema},
    {"failures", optional,
     "failure files, or folders of them, whose scenes are shown and judged; the scenes are the "
     "axis \"scene\" where there is none",
     failures_schema},
    {"images", optional, "methods whose images vecino does not make, by name", images_schema},
    {"reference", optional, "the render, or the file, that cells are held against",
     reference_schema},
    {"measure", optional, "", [] { return object_schema(kMeasureKeys); }},
    {"stability", optional, "measure what seeds, moved cameras and other parameters change",
     stability_schema},
    {"gates", optional, "classes of cells and how much worse than a baseline each may be",
     gates_schema},
    {"reproduction", optional, "what a publication states, to be held against the results",
     reproduction_schema},
};

}  // namespace

json free_axes_schema() {
    json schema = cell_schema();
    for (const auto& [key, property] : schema["properties"].items()) {
        const json one = property;
        property = {{"anyOf", {one, array_schema(one, {1, 0})}}};
        property["description"] = one.value("description", "");
    }
    return schema;
}

json free_selection_schema() {
    json schema = free_axes_schema();
    for (const char* key : {"scheme", "image"}) schema["properties"].erase(key);
    schema["properties"]["method"] = {{"type", {"string", "array"}}};
    return schema;
}

json matrix_schema() {
    json schema = object_schema(kMatrixKeys);
    // A matrix that extends another one may leave to it what has to be there.
    const json whole_reproduction{{"required", {"source", "variants"}}};
    schema["anyOf"] = {{{"required", {"extends"}}},
                       {{"required", {"axes", "reference"}},
                        {"properties", {{"reproduction", whole_reproduction}}}}};
    return document_schema("An evaluation matrix of vecino", schema);
}

}  // namespace vecino
