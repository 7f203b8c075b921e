// SPDX-License-Identifier: Apache-2.0
//
// The options of the schemes: the one table that the command line, matrices, cell names and help
// follow from.
#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/json_schema.h"
#include "filters/option_names.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

constexpr IntegerKind kWindow{1, 9999};  // and odd
constexpr std::string_view kWindowAllowed = "an odd integer from 1 to 9999";

constexpr Named<Metric> kMetrics[] = {
    {"euclidean", Metric::euclidean},
    {"manhattan", Metric::manhattan},
};

constexpr ChoiceKind kWeighting{kWeightings};
constexpr ChoiceKind kMetric{kMetrics};
constexpr RealKind kCosine{{-1.0, 1.0}};
constexpr BooleanKind kSwitch{};
constexpr IntegerKind kOrder{0, 2};
constexpr IntegerKind kGuideScale{1, 16};

void set_window(SchemeParameters& parameters, const JsonValue& json) {
    const int window = kWindow.read(json);
    if (window % 2 == 0) json.fail(std::string(kWindowAllowed));
    parameters.window = window;
}

nlohmann::json window_schema() {
    nlohmann::json schema = kWindow.schema();
    schema["not"] = {{"multipleOf", 2}};
    return schema;
}

/// "w7"
std::string window_slug(const SchemeParameters& parameters) {
    std::string slug = "w";
    slug += std::to_string(parameters.window);
    return slug;
}

std::string cosine_slug(const SchemeParameters& parameters) {
    return number_slug("c", parameters.min_normal_cosine);
}

using Parameters = SchemeParameters;

/// "o2" or "g4": a letter and a number.
template <char kLetter, int Parameters::*kMember>
std::string number_slug(const Parameters& parameters) {
    return kLetter + std::to_string(parameters.*kMember);
}

const SchemeOption kOptions[] = {
    {"window", "--window", kWindowAllowed, "side of the neighbourhood, in low-resolution pixels",
     set_window, window_slug, window_schema},
    {"weighting", "--weighting", "proportional, inverse, gaussian",
     "how the weight of a neighbour follows from its distance",
     read_into<kWeighting, &Parameters::weighting>,
     [](const Parameters& p) { return name_of(kWeightings, p.weighting); }, schema_of<kWeighting>},
    {"metric", "--metric", "euclidean, manhattan", "how distances in the image are measured",
     read_into<kMetric, &Parameters::metric>,
     [](const Parameters& p) { return name_of(kMetrics, p.metric); }, schema_of<kMetric>},
    {"min_normal_cosine", "--min-normal-cosine", "a number from -1 to 1",
     "only neighbours count whose normal has a larger cosine to the centre's",
     read_into<kCosine, &Parameters::min_normal_cosine>, cosine_slug, schema_of<kCosine>},
    {"use_centre", "--no-centre", "true or false",
     "whether a pixel counts among its own neighbours", read_into<kSwitch, &Parameters::use_centre>,
     [](const Parameters& p) { return std::string(p.use_centre ? "centre" : "no_centre"); },
     schema_of<kSwitch>},
    {"order", "--order", "0, 1, 2", "highest order of the polynomials that are fitted",
     read_into<kOrder, &Parameters::order>, number_slug<'o', &Parameters::order>,
     schema_of<kOrder>},
    {"guide_scale", "", "1 to 16", "samples of the guide per pixel, along each axis",
     read_into<kGuideScale, &Parameters::guide_scale>, number_slug<'g', &Parameters::guide_scale>,
     schema_of<kGuideScale>},
};

}  // namespace

std::span<const SchemeOption> scheme_options() {
    return kOptions;
}

const SchemeOption& find_scheme_option(std::string_view name) {
    const auto* row = std::ranges::find(kOptions, name, &SchemeOption::name);
    if (row != std::end(kOptions)) return *row;
    std::vector<std::string_view> allowed;
    for (const SchemeOption& option : kOptions) allowed.push_back(option.name);
    throw Error(ExitCode::usage,
                "scheme option: found \"" + std::string(name) + "\", allowed: " + join(allowed));
}

}  // namespace vecino
