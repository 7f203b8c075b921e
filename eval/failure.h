// SPDX-License-Identifier: Apache-2.0
//
// A known way in which methods fail: a scene that shows it and nothing else, the number that tells
// how badly, and what is expected of whom. Stands beside its scene: NAME.failure.json is of
// NAME.json. The limits are set from the reference before any method is measured.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/frame.h"
#include "eval/selection.h"
#include "eval/signatures.h"

namespace vecino {

/// By the failure's limits; the worse the later. All signatures grow with the failure.
enum class FailureVerdict {
    pass,      ///< at most pass_below
    degraded,  ///< between both limits
    fails,     ///< above fails_above, not finite, or without an image
    refuses,   ///< no value: the method does not allow the settings that the scene needs
};

std::string verdict_name(FailureVerdict verdict);

/// What is expected of the methods that it names.
struct Expectation {
    std::vector<std::string> methods;  ///< names of methods; * stands for any characters
    Selection where;                   ///< of these, which results
    std::vector<FailureVerdict> verdicts;
    std::string why;  ///< may be empty
};

/// A sample of the low-resolution frame that is replaced before a scheme reads it.
struct Injection {
    float u = 0, v = 0;  ///< where in the image, in [0, 1)
    float value = 0;     ///< NaN or infinite
};

/// The exact radiance of what an object shows.
struct ExactRadiance {
    int object = 0;
    glm::vec3 radiance{0.0f};
    std::string formula;
};

struct FailureCase {
    std::string id;  ///< "F03"; scenes of one hole share it
    std::string title;
    std::string mechanism;
    std::string scene;  ///< path of the scene file
    std::string reference;
    std::vector<ExactRadiance> exact;  ///< where known, beside the path-traced reference
    Measure measure;
    std::vector<Measure> also;  ///< shown beside it, not judged
    double pass_below = 0, fails_above = 0;
    std::string limits_from;
    std::vector<Injection> inject;
    std::vector<std::string> not_for;  ///< methods that the measure says nothing of
    std::vector<Expectation> expect;   ///< the first that fits counts

    [[nodiscard]] FailureVerdict verdict(double value) const;
    /// Whether the measure means something for a result with these params (of results.jsonl).
    [[nodiscard]] bool is_for(const nlohmann::json& params) const;
    /// What is expected of a result with these params (of results.jsonl); null: nothing.
    [[nodiscard]] const Expectation* expected(const nlohmann::json& params) const;
};

/// Throws Error(usage), for an unknown key too. "needs" is checked here, and read where a matrix is
/// expanded.
FailureCase read_failure(const JsonValue& json);

/// Of a failure file, from the tables that it is read by.
nlohmann::json failure_schema();
/// The same without what a whole document's schema says of itself.
nlohmann::json failure_object_schema();

/// The documents that "failures" of a matrix names, in order: files, or all *.failure.json of a
/// folder by name; objects stay as they are. "scene" is then a path from the matrix's folder.
/// Throws Error(file), Error(usage).
nlohmann::json embedded_failures(const JsonValue& failures);

/// {"u":, "v":, "value": "nan"}
nlohmann::json injection_json(const Injection& injection);

/// Puts the injected values into a frame's radiance.
void inject(const std::vector<Injection>& injections, Frame& frame);

/// Text with * for any characters.
bool matches_glob(std::string_view pattern, std::string_view text);

}  // namespace vecino
