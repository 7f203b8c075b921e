// SPDX-License-Identifier: Apache-2.0
//
// The options of the render methods: the one table that the command line, matrices, cell names and
// help follow from.
#include <bit>
#include <limits>
#include <string>
#include <vector>

#include "core/json_schema.h"
#include "filters/method_rows.h"
#include "filters/methods.h"
#include "filters/option_names.h"

namespace vecino {
namespace {

using Parameters = MethodParameters;
using P = const MethodParameters&;
using nlohmann::json;

constexpr Named<Interleaving> kInterleavings[] = {
    {"lattice", Interleaving::lattice},
    {"subsequence", Interleaving::subsequence},
};
constexpr Named<LatticeMask> kMasks[] = {
    {"square", LatticeMask::square},
    {"quincunx", LatticeMask::quincunx},
};
constexpr Named<LatticeKernel> kKernels[] = {
    {"distance3d_normal", LatticeKernel::distance3d_normal},
    {"surface", LatticeKernel::surface},
};
constexpr Named<Reused> kReusedColours[] = {
    {"nearest", Reused::nearest},
    {"mean", Reused::mean},
};
constexpr Named<VariationRule> kVariationRules[] = {
    {"sample_difference", VariationRule::sample_difference},
    {"mean_change", VariationRule::mean_change},
    {"standard_error", VariationRule::standard_error},
    {"scramblings", VariationRule::scramblings},
};

constexpr ChoiceKind kInterleaving{kInterleavings};
constexpr ChoiceKind kMask{kMasks};
constexpr ChoiceKind kKernel{kKernels};
constexpr ChoiceKind kReused{kReusedColours};
constexpr ChoiceKind kVariationRule{kVariationRules};
constexpr ChoiceKind kWeighting{kWeightings};
constexpr RealKind kCosine{{-1.0, 1.0}};
constexpr RealKind kRadius{{0.0, 64.0}};
constexpr RealKind kNotNegative{{0.0, 1e6}};
constexpr IntegerKind kStep{1, 64};
constexpr IntegerKind kSpp{1, std::numeric_limits<int>::max()};
constexpr BooleanKind kSwitch{};

constexpr std::string_view kCoarseSteps = "1, 2, 4, 8, 16, 32, 64";

void set_coarse_step(Parameters& parameters, const JsonValue& value) {
    const int step = kStep.read(value);
    if (!std::has_single_bit(static_cast<unsigned>(step))) value.fail(std::string(kCoarseSteps));
    parameters.coarse_step = step;
}

json coarse_step_schema() {
    return {{"enum", {1, 2, 4, 8, 16, 32, 64}}};
}

std::string integer_slug(const char* letter, int number) {
    return letter + std::to_string(number);
}

// clang-format off
const MethodOption kOptions[] = {
    {"weighting", "--weighting", "proportional, inverse, gaussian", "of interpolated pixels: how the weight of a traced one follows from its distance",
     read_into<kWeighting, &Parameters::weighting>,
     [](P p) { return json(name_of(kWeightings, p.weighting)); },
     [](P p) { return name_of(kWeightings, p.weighting); }, schema_of<kWeighting>},
    {"min_normal_cosine", "--min-normal-cosine", "a number from -1 to 1", "only hits whose normals have a larger cosine are of one surface",
     read_into<kCosine, &Parameters::min_normal_cosine>,
     [](P p) { return json(shortest(p.min_normal_cosine)); },
     [](P p) { return number_slug("c", p.min_normal_cosine); }, schema_of<kCosine>},
    {"interleaving", "--interleaving", "lattice, subsequence", "of interleaved: pixels are shared out, or the samples of one set",
     read_into<kInterleaving, &Parameters::interleaving>,
     [](P p) { return json(name_of(kInterleavings, p.interleaving)); },
     [](P p) { return name_of(kInterleavings, p.interleaving); }, schema_of<kInterleaving>},
    {"mask", "--mask", "square, quincunx", "of a lattice: every step-th pixel, or every second one of these (of step 1: a checkerboard)",
     read_into<kMask, &Parameters::mask>,
     [](P p) { return json(name_of(kMasks, p.mask)); },
     [](P p) { return name_of(kMasks, p.mask); }, schema_of<kMask>},
    {"kernel", "--kernel", "distance3d_normal, surface", "of a lattice: radiance of hits with a like normal, or light of the same surface",
     read_into<kKernel, &Parameters::kernel>,
     [](P p) { return json(name_of(kKernels, p.kernel)); },
     [](P p) { return name_of(kKernels, p.kernel); }, schema_of<kKernel>},
    {"step", "--step", "1 to 64", "of interleaved: pixels from one of the lattice to the next, or side of the box",
     read_into<kStep, &Parameters::step>,
     [](P p) { return json(p.step); },
     [](P p) { return integer_slug("step", p.step); }, schema_of<kStep>},
    {"coarse_step", "--coarse-step", kCoarseSteps, "of adaptive: pixels between those that are traced first",
     set_coarse_step,
     [](P p) { return json(p.coarse_step); },
     [](P p) { return integer_slug("coarse", p.coarse_step); }, coarse_step_schema},
    {"tolerance", "--tolerance", "a number >= 0", "of adaptive: relative difference of light that is interpolated across, beside noise",
     read_into<kNotNegative, &Parameters::tolerance>,
     [](P p) { return json(shortest(p.tolerance)); },
     [](P p) { return number_slug("t", p.tolerance); }, schema_of<kNotNegative>},
    {"correction", "--correction", "true or false", "of adaptive: whether interpolated pixels near a wrong guess are traced after all",
     read_into<kSwitch, &Parameters::correction>,
     [](P p) { return json(p.correction); },
     [](P p) { return std::string(p.correction ? "corrected" : "uncorrected"); }, schema_of<kSwitch>},
    {"radius", "--radius", "0 to 64", "of reuse: how near a traced hit has to be, in footprints of a pixel",
     read_into<kRadius, &Parameters::radius>,
     [](P p) { return json(shortest(p.radius)); },
     [](P p) { return number_slug("r", p.radius); }, schema_of<kRadius>},
    {"reused", "--reused", "nearest, mean", "of reuse: the colour of the nearest traced hit, or the weighted mean of all in reach",
     read_into<kReused, &Parameters::reused>,
     [](P p) { return json(name_of(kReusedColours, p.reused)); },
     [](P p) { return name_of(kReusedColours, p.reused); }, schema_of<kReused>},
    {"variation_rule", "--variation-rule", "sample_difference, mean_change, standard_error, scramblings", "of variation: what has to fall below the bound",
     read_into<kVariationRule, &Parameters::variation_rule>,
     [](P p) { return json(name_of(kVariationRules, p.variation_rule)); },
     [](P p) { return name_of(kVariationRules, p.variation_rule); }, schema_of<kVariationRule>},
    {"variation_bound", "--variation-bound", "a number >= 0", "of variation: in units of radiance; of scramblings, of its square root",
     read_into<kNotNegative, &Parameters::variation_bound>,
     [](P p) { return json(shortest(p.variation_bound)); },
     [](P p) { return number_slug("b", p.variation_bound); }, schema_of<kNotNegative>},
    {"min_spp", "--min-spp", "an integer >= 1", "of variation: samples before the first look; default 16, without nee 512",
     read_into<kSpp, &Parameters::min_spp>,
     [](P p) { return p.min_spp > 0 ? json(p.min_spp) : json("default"); },
     [](P p) { return integer_slug("min", p.min_spp); }, schema_of<kSpp>},
};
// clang-format on

}  // namespace

std::span<const MethodOption> method_options() {
    static const std::vector<MethodOption> rows = [] {
        std::vector<MethodOption> all(std::begin(kOptions), std::end(kOptions));
        for (const MethodOption& row : surface_records_rows()) all.push_back(row);
        for (const MethodOption& row : auto_rows()) all.push_back(row);
        return all;
    }();
    return rows;
}

}  // namespace vecino
