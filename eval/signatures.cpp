// SPDX-License-Identifier: Apache-2.0
//
// The table of signatures, and their parameters as files have them.
#include "eval/signatures.h"

#include <algorithm>
#include <limits>

#include "core/json_schema.h"
#include "eval/signature_values.h"

namespace vecino {
namespace {

using Json = nlohmann::json;
using enum Presence;

constexpr IntegerKind kObject{-1, std::numeric_limits<int>::max()};
constexpr RealKind kPixels{{0.0, 1e6}};
constexpr RealKind kShare{{0.0, 1.0}};
constexpr RealKind kThreshold{{0.0, 1e6}};
constexpr RealKind kContrast{{1e-6, 1e6}};
constexpr RealKind kAngle{{0.0, 180.0}};
constexpr Vec3Kind kRadiance{{0.0, 1e30}};
constexpr Named<Axis> kAxes[] = {{"x", Axis::x}, {"y", Axis::y}};
constexpr ChoiceKind kAxis{kAxes};

std::vector<int> read_objects(const JsonValue& json) {
    std::vector<int> objects;
    for (const JsonValue& each : json.elements()) objects.push_back(kObject.read(each));
    if (objects.empty()) json.fail("at least one object");
    return objects;
}

Json objects_schema() {
    return array_schema(kObject.schema(), {1, 0});
}

template <std::size_t N, const auto& kKind>
std::array<float, N> read_reals(const JsonValue& json) {
    const auto elements = json.elements();
    if (elements.size() != N) json.fail(std::to_string(N) + " numbers");
    std::array<float, N> values{};
    std::ranges::transform(elements, values.begin(),
                           [](const JsonValue& each) { return kKind.read(each); });
    return values;
}

constexpr JsonKey<Where> kWhereKeys[] = {
    {"on", optional, "objects of the scene, by index; -1: misses",
     [](Where& where, const JsonValue& json) { where.on = read_objects(json); }, objects_schema},
    {"near", optional, "objects that the pixels are close to",
     [](Where& where, const JsonValue& json) { where.near = read_objects(json); }, objects_schema},
    {"within_px", optional, "least and most distance to the nearest pixel of these",
     [](Where& where, const JsonValue& json) { where.within_px = read_reals<2, kPixels>(json); },
     [] {
         return array_schema(kPixels.schema(), {2, 2});
     }},
    {"box", optional, "u and v of two corners of the image, from the top left",
     [](Where& where, const JsonValue& json) { where.box = read_reals<4, kShare>(json); },
     [] {
         return array_schema(kShare.schema(), {4, 4});
     }},
};

using Parameters = SignatureParameters;

constexpr JsonKey<Parameters> kKeys[] = {
    {"where", optional, "the pixels that are looked at; default: all",
     [](Parameters& parameters, const JsonValue& json) {
         read_object(json, kWhereKeys, parameters.where);
     },
     [] { return object_schema(kWhereKeys); }},
    member_key<kObject, &Parameters::far>("far", optional, "the object whose colour intrudes"),
    {"objects", optional, "those that are looked at one by one",
     [](Parameters& parameters, const JsonValue& json) { parameters.objects = read_objects(json); },
     objects_schema},
    member_key<kContrast, &Parameters::contrast>("contrast", optional,
                                                 "the radiance that counts as 1"),
    member_key<kThreshold, &Parameters::threshold>("threshold", optional,
                                                   "as a share of the contrast"),
    member_key<kPixels, &Parameters::reach_px>("reach_px", optional, "how far around an object"),
    member_key<kAxis, &Parameters::across>("across", optional,
                                           "the direction that crosses an edge"),
    member_key<kRadiance, &Parameters::expected>("expected", optional, "the exact radiance"),
    member_key<kAngle, &Parameters::min_angle_degrees>("min_angle_degrees", optional,
                                                       "between normals of neighbouring pixels"),
};

constexpr std::string_view kNone[] = {"where"};
constexpr std::string_view kContrastKeys[] = {"where", "contrast"};
constexpr std::string_view kFarKeys[] = {"where", "far"};
constexpr std::string_view kWidthKeys[] = {"where", "objects", "contrast", "threshold"};
constexpr std::string_view kSwapKeys[] = {"where", "objects", "far"};
constexpr std::string_view kEnergyKeys[] = {"where", "objects"};
constexpr std::string_view kFlipKeys[] = {"where", "contrast", "threshold"};
constexpr std::string_view kFacetKeys[] = {"where", "contrast", "min_angle_degrees"};
constexpr std::string_view kShiftKeys[] = {"objects", "reach_px"};
constexpr std::string_view kEdgeKeys[] = {"where", "across"};
constexpr std::string_view kBlobKeys[] = {"contrast", "threshold"};
constexpr std::string_view kExactKeys[] = {"where", "expected"};

// x is the image, r the reference, both linear; sums are over the pixels of "where" and channels.
// clang-format off
const Signature kSignatures[] = {
    {"rms_error", "sqrt(mean of (x-r)^2) / contrast", "of contrast", kContrastKeys, rms_error},
    {"mean_error", "|mean of (x-r)| / mean of r", "share", kNone, mean_error},
    {"far_share", "share of the far object's colour F in a pixel of another: mean of dot(x-r, F-r) / |F-r|^2, at least 0", "share", kFarKeys, far_share},
    {"swap_width", "pixels that hold more than half of the far object's colour, per pixel of the objects' outline", "px", kSwapKeys, swap_width},
    {"halo_width", "pixels in which some channel has |x-r| > threshold x contrast, per pixel of the objects' outline", "px", kWidthKeys, halo_width},
    {"leaked_energy", "sum of max(0, x-r) / sum of r over the pixels of the objects", "share", kEnergyKeys, leaked_energy},
    {"lost_contrast", "1 - slope of the regression of x on r, at least 0; above 1 the pattern is inverted", "share", kNone, lost_contrast},
    {"edge_widening", "width of the ramp across an edge, less the reference's: 6 x sum of p(1-p), p the mean profile from 0 to 1", "px", kEdgeKeys, edge_widening},
    {"centroid_shift", "the largest shift of an object's centroid against the reference's, within reach_px around it", "px", kShiftKeys, centroid_shift},
    {"seam_step", "rms over neighbouring pixels of different objects of the step that is not in the reference / contrast", "of contrast", kContrastKeys, seam_step},
    {"facet_step", "rms of the steps that are not in the reference where normals differ, less that where they do not, at least 0 / contrast", "of contrast", kFacetKeys, facet_step},
    {"seed_flips", "share of pixels whose range over seeds exceeds threshold x contrast in some channel", "share", kFlipKeys, seed_flips},
    {"seed_noise", "standard deviation over seeds, rms over pixels / mean of r", "of mean", kNone, seed_noise},
    {"outlier_area", "mean area of connected pixels with x-r > threshold x contrast in some channel; 0 without any", "px", kBlobKeys, outlier_area},
    {"deviation", "max of |x-e| / max(e), e the exact radiance; |x-e| where that is 0", "share", kExactKeys, deviation},
    {"differs_from_path", "max of |x-p| / mean of p, p path tracing's image of the same seed", "share", kNone, differs_from_path},
    {"damaged_blocks", "pixels with |x-r| > threshold x contrast, in low-resolution pixels per injected sample; infinite where counts do not tell of the samples", "blocks", kBlobKeys, damaged_blocks},
    {"fallbacks", "low-resolution pixels that kept their own colour because no neighbour had a weight", "share", {}, fallbacks},
};
// clang-format on

const Signature& find_signature(const JsonValue& json) {
    std::vector<std::string_view> names;
    for (const Signature& each : kSignatures) {
        if (each.name == json.string()) return each;
        names.push_back(each.name);
    }
    json.fail(join(names));
}

Json name_schema() {
    Json schema;
    for (const Signature& each : kSignatures) schema["enum"].push_back(each.name);
    return schema;
}

/// A key that the signature names has to be there, but for where: a default would be a guess.
void require_keys(const JsonValue& json, const Signature& signature) {
    std::vector<std::string_view> allowed(signature.keys.begin(), signature.keys.end());
    for (const std::string_view key : allowed)
        if (key != "where") (void)json.at(key);
    allowed.insert(allowed.begin(), "signature");
    json.require_keys(allowed);
}

}  // namespace

std::span<const Signature> all_signatures() {
    return kSignatures;
}

Measure read_measure(const JsonValue& json) {
    Measure measure{&find_signature(json.at("signature")), {}};
    require_keys(json, *measure.signature);
    for (const JsonKey<Parameters>& key : kKeys)
        if (json.has(key.name)) key.read(measure.parameters, json.at(key.name));
    return measure;
}

Json measure_schema() {
    Json schema = object_schema(kKeys);
    schema["properties"]["signature"] = name_schema();
    schema["required"] = {"signature"};
    for (const Signature& each : kSignatures) {
        Json keys{{"signature", {{"const", each.name}}}};
        std::vector<std::string_view> needed;
        for (const std::string_view key : each.keys) {
            keys[std::string(key)] = true;
            if (key != "where") needed.push_back(key);
        }
        Json one{{"properties", keys}, {"additionalProperties", false}};
        if (!needed.empty()) one["required"] = needed;
        schema["oneOf"].push_back(std::move(one));
    }
    return schema;
}

SignatureValues measured(const Measure& measure, const SignatureInput& input) {
    return measure.signature->values(input);
}

}  // namespace vecino
