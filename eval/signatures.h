// SPDX-License-Identifier: Apache-2.0
//
// Numbers that tell one failure each: how wide a ring is, how much of a far surface's colour an
// edge holds, how many pixels flip with the seed. A global error hides what they show. All of them
// are at least 0 and grow with the failure; values that are not finite fail. A signature is a row
// of the table in signatures.cpp; schemas, errors and the report follow from it.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/frame.h"
#include "core/json_read.h"

namespace vecino {

/// Which pixels a signature looks at; all that is given has to hold. Objects are those of the
/// reference's first hits, by their index in the scene; -1 is a miss.
struct Where {
    std::vector<int> on;                      ///< objects; empty: any
    std::vector<int> near;                    ///< objects; empty: no matter how far
    std::array<float, 2> within_px{0, 1e9f};  ///< least and most distance to a pixel of `near`
    std::array<float, 4> box{0, 0, 1, 1};     ///< u and v of two corners of the image
};

enum class Axis { x, y };

/// What signatures can be told. Each reads those that its row names.
struct SignatureParameters {
    Where where;
    int far = -1;                  ///< the object whose colour intrudes
    std::vector<int> objects;      ///< those that are looked at one by one
    double contrast = 1;           ///< the radiance that counts as 1, > 0
    double threshold = 0.5;        ///< as a share of contrast
    double reach_px = 4;           ///< how far around an object
    Axis across = Axis::x;         ///< the direction that crosses an edge
    glm::vec3 expected{0.0f};      ///< radiance
    double min_angle_degrees = 5;  ///< between normals of neighbouring pixels
};

/// What a group of results gives: the same cell for each of its seeds. All images have one size.
struct SignatureInput {
    std::span<const Image> images;         ///< by seed
    std::span<const Image> path;           ///< path tracing's, by the same seeds; may be empty
    std::span<const nlohmann::json> rows;  ///< of results.jsonl, by seed
    const Frame& reference;                ///< with first hits
    const SignatureParameters& parameters;
};

/// By seed; what needs all seeds at once has the same value for each.
using SignatureValues = std::vector<double>;

struct Signature {
    std::string_view name;                   ///< "signature" in a measure
    std::string_view summary;                ///< one line
    std::string_view unit;                   ///< "px", "share" or empty
    std::span<const std::string_view> keys;  ///< of SignatureParameters, beside "where"
    SignatureValues (*values)(const SignatureInput&);
};

/// A signature with its parameters.
struct Measure {
    const Signature* signature = nullptr;
    SignatureParameters parameters;
};

std::span<const Signature> all_signatures();

/// {"signature": NAME, "where": {...}, ...}. Throws Error(usage).
Measure read_measure(const JsonValue& json);

nlohmann::json measure_schema();

/// Values by seed. Throws Error(usage) if the measure's pixels are not in the image,
/// Error(mismatch) if the reference lacks the planes that tell objects apart.
SignatureValues measured(const Measure& measure, const SignatureInput& input);

}  // namespace vecino
