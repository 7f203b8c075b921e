// SPDX-License-Identifier: Apache-2.0
#include "eval/failure.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/error.h"
#include "core/json_schema.h"
#include "eval/axes.h"
#include "eval/matrix_schema.h"

namespace vecino {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using enum Presence;

constexpr const char* kSuffix = ".failure.json";

constexpr TextKind kText{};
constexpr NumberRange kLimit{0.0, 1e9};
constexpr RealKind kLimitKind{kLimit};
constexpr RealKind kShare{{0.0, 0.999999}};
constexpr IntegerKind kObject{-1, std::numeric_limits<int>::max()};
constexpr Vec3Kind kRadiance{{0.0, 1.0e30}};

constexpr Named<FailureVerdict> kVerdicts[] = {
    {"pass", FailureVerdict::pass},
    {"degraded", FailureVerdict::degraded},
    {"fails", FailureVerdict::fails},
    {"refuses", FailureVerdict::refuses},
};
constexpr ChoiceKind kVerdictKind{kVerdicts};

constexpr Named<float> kBadValues[] = {
    {"nan", std::numeric_limits<float>::quiet_NaN()},
    {"inf", std::numeric_limits<float>::infinity()},
    {"-inf", -std::numeric_limits<float>::infinity()},
};
constexpr ChoiceKind kBadValue{kBadValues};

/// One value, or an array of at least one.
std::vector<JsonValue> one_or_several(const JsonValue& json) {
    if (!json.raw().is_array()) return {json};
    auto values = json.elements();
    if (values.empty()) json.fail("at least one value");
    return values;
}

Json one_or_several_schema(const Json& one) {
    return {{"anyOf", {one, array_schema(one, {1, 0})}}};
}

// ---- What is expected -----------------------------------------------------------------------

constexpr JsonKey<Expectation> kExpectationKeys[] = {
    {"methods", required, "names of methods, * for any characters",
     [](Expectation& expectation, const JsonValue& json) {
         for (const JsonValue& each : one_or_several(json))
             expectation.methods.push_back(each.string());
     },
     [] { return one_or_several_schema(kText.schema()); }},
    {"where", optional, "of these, which results, by their parameters",
     [](Expectation& expectation, const JsonValue& json) {
         expectation.where = Selection::read(json);
     },
     [] { return free_selection_schema(); }},
    {"verdict", required,
     "one or several; refuses: the method does not allow the settings that the scene needs",
     [](Expectation& expectation, const JsonValue& json) {
         for (const JsonValue& each : one_or_several(json))
             expectation.verdicts.push_back(kVerdictKind.read(each));
     },
     [] { return one_or_several_schema(kVerdictKind.schema()); }},
    member_key<kText, &Expectation::why>("why", optional, ""),
};

constexpr JsonKey<Injection> kInjectionKeys[] = {
    member_key<kShare, &Injection::u>("u", required, "from the left, in widths of the image"),
    member_key<kShare, &Injection::v>("v", required, "from the top, in heights of the image"),
    member_key<kBadValue, &Injection::value>("value", required, "of all three channels"),
};

constexpr JsonKey<ExactRadiance> kExactKeys[] = {
    member_key<kObject, &ExactRadiance::object>("object", required,
                                                "index in the scene; -1: a miss"),
    member_key<kRadiance, &ExactRadiance::radiance>("radiance", required, ""),
    member_key<kText, &ExactRadiance::formula>("formula", required, ""),
};

template <class Row, const auto& kKeys, auto kMember>
void read_rows(FailureCase& failure, const JsonValue& json) {
    for (const JsonValue& each : json.elements()) {
        Row row;
        read_object(each, kKeys, row);
        (failure.*kMember).push_back(std::move(row));
    }
}

template <const auto& kKeys>
Json rows_schema() {
    return array_schema(object_schema(kKeys), {0, 0});
}

// ---- The failure ----------------------------------------------------------------------------

/// What a scene decides itself, not its failure.
bool may_be_needed(std::string_view key) {
    constexpr std::string_view kApart[] = {"scene", "scheme", "method", "image", "seed", "budget"};
    return std::ranges::find(kApart, key) == std::end(kApart);
}

void check_needs(FailureCase&, const JsonValue& json) {
    std::vector<std::string_view> keys;
    for (const std::string_view key : cell_keys())
        if (may_be_needed(key)) keys.push_back(key);
    json.require_keys(keys);
    (void)read_axes(json);
}

Json needs_schema() {
    Json schema = free_axes_schema();
    for (const std::string_view key : cell_keys())
        if (!may_be_needed(key)) schema["properties"].erase(std::string(key));
    return schema;
}

void read_also(FailureCase& failure, const JsonValue& json) {
    for (const JsonValue& each : json.elements()) failure.also.push_back(read_measure(each));
}

constexpr JsonKey<FailureCase> kKeys[] = {
    {"$schema", optional, "the JSON Schema of failures, for editors",
     [](FailureCase&, const JsonValue& json) { (void)json.string(); }, schema_of<kText>},
    member_key<kText, &FailureCase::id>("id", required, "of the hole; scenes of one hole share it"),
    member_key<kText, &FailureCase::title>("title", required, "unique among failures"),
    member_key<kText, &FailureCase::mechanism>("mechanism", required, "why it happens"),
    member_key<kText, &FailureCase::scene>(
        "scene", optional, "from this file's folder; NAME.failure.json is of NAME.json otherwise"),
    {"needs", required,
     "settings that show it, in place of a matrix's: size, spp, max_depth, ...; several values "
     "are several cells",
     check_needs, needs_schema},
    member_key<kText, &FailureCase::reference>("reference", required,
                                               "what is held against, and how sure it is"),
    {"exact", optional, "exact radiances of objects, away from their edges",
     read_rows<ExactRadiance, kExactKeys, &FailureCase::exact>, rows_schema<kExactKeys>},
    {"measure", required, "the number that tells how badly",
     [](FailureCase& failure, const JsonValue& json) { failure.measure = read_measure(json); },
     measure_schema},
    {"also", optional, "numbers beside it, which are not judged", read_also,
     [] {
         return array_schema(measure_schema(), {0, 0});
     }},
    member_key<kLimitKind, &FailureCase::pass_below>("pass_below", required,
                                                     "up to this value a method passes"),
    member_key<kLimitKind, &FailureCase::fails_above>("fails_above", required,
                                                      "beyond this value it fails"),
    member_key<kText, &FailureCase::limits_from>("limits_from", required,
                                                 "what both limits follow from"),
    {"inject", optional, "samples of the low-resolution frame that are replaced",
     read_rows<Injection, kInjectionKeys, &FailureCase::inject>, rows_schema<kInjectionKeys>},
    {"not_for", optional, "methods that the measure says nothing of, as under \"expect\"",
     [](FailureCase& failure, const JsonValue& json) {
         for (const JsonValue& each : one_or_several(json))
             failure.not_for.push_back(each.string());
     },
     [] { return one_or_several_schema(kText.schema()); }},
    {"expect", required, "what is expected; the first row that fits a result counts",
     read_rows<Expectation, kExpectationKeys, &FailureCase::expect>, rows_schema<kExpectationKeys>},
};

// ---- Files ----------------------------------------------------------------------------------

std::vector<fs::path> failure_files(const fs::path& path, const JsonValue& json) {
    if (!fs::is_directory(path)) return {path};
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path))
        if (entry.path().string().ends_with(kSuffix)) files.push_back(entry.path());
    if (files.empty()) json.fail("a folder with files *" + std::string(kSuffix));
    std::ranges::sort(files);
    return files;
}

Json load_failure(const fs::path& file, const fs::path& folder) {
    Json document = parse_json_file(file.string());
    const JsonValue json(document, file.string());
    (void)read_failure(json);
    const std::string name = file.filename().string();
    fs::path scene = file.parent_path();
    if (json.has("scene")) {
        scene /= json.at("scene").string();
    } else if (name.ends_with(kSuffix)) {
        scene /= name.substr(0, name.size() - std::string_view(kSuffix).size()) + ".json";
    } else {
        json.fail("a file without \"scene\"",
                  "\"scene\", or a name that ends in " + std::string(kSuffix));
    }
    document.erase("$schema");
    document["scene"] =
        scene.lexically_normal().lexically_proximate(folder.lexically_normal()).generic_string();
    return document;
}

}  // namespace

std::string verdict_name(FailureVerdict verdict) {
    return name_of(kVerdicts, verdict);
}

FailureVerdict FailureCase::verdict(double value) const {
    if (!(value <= fails_above)) return FailureVerdict::fails;  // NaN fails, too
    return value <= pass_below ? FailureVerdict::pass : FailureVerdict::degraded;
}

const Expectation* FailureCase::expected(const Json& params) const {
    const std::string method = params.value("method", "");
    const auto found = std::ranges::find_if(expect, [&](const Expectation& each) {
        const auto fits = [&](const std::string& name) { return matches_glob(name, method); };
        return std::ranges::any_of(each.methods, fits) && each.where.matches(params);
    });
    return found == expect.end() ? nullptr : &*found;
}

bool FailureCase::is_for(const Json& params) const {
    if (!inject.empty() && !params.contains("inject")) return false;
    const std::string method = params.value("method", "");
    return std::ranges::none_of(
        not_for, [&](const std::string& name) { return matches_glob(name, method); });
}

FailureCase read_failure(const JsonValue& json) {
    FailureCase failure;
    read_object(json, kKeys, failure);
    failure.pass_below = json.at("pass_below").number(kLimit);
    failure.fails_above = json.at("fails_above").number(kLimit);
    if (failure.pass_below > failure.fails_above)
        json.at("fails_above").fail("a number of at least \"pass_below\"");
    return failure;
}

Json failure_object_schema() {
    return object_schema(kKeys);
}

Json failure_schema() {
    return document_schema("A failure that a scene of vecino shows", failure_object_schema());
}

Json embedded_failures(const JsonValue& failures) {
    const fs::path folder = fs::path(failures.file()).parent_path();
    Json documents = Json::array();
    for (const JsonValue& each : failures.elements()) {
        if (each.raw().is_object()) {
            documents.push_back(each.raw());
            continue;
        }
        for (const fs::path& file : failure_files(folder / each.string(), each))
            documents.push_back(load_failure(file, folder));
    }
    return documents;
}

Json injection_json(const Injection& injection) {
    const auto is_same = [&](const Named<float>& each) {
        return std::isnan(each.value) ? std::isnan(injection.value) : each.value == injection.value;
    };
    const auto* const name = std::ranges::find_if(kBadValues, is_same);
    return {{"u", injection.u}, {"v", injection.v}, {"value", name->name}};
}

void inject(const std::vector<Injection>& injections, Frame& frame) {
    const Extent size = frame.radiance.size();
    for (const Injection& each : injections) {
        const int x = static_cast<int>(each.u * static_cast<float>(size.width));
        const int y = static_cast<int>(each.v * static_cast<float>(size.height));
        frame.radiance(x, y) = glm::vec3(each.value);
    }
}

bool matches_glob(std::string_view pattern, std::string_view text) {
    if (pattern.empty()) return text.empty();
    if (pattern.front() != '*')
        return !text.empty() && text.front() == pattern.front() &&
               matches_glob(pattern.substr(1), text.substr(1));
    for (std::size_t skipped = 0; skipped <= text.size(); ++skipped)
        if (matches_glob(pattern.substr(1), text.substr(skipped))) return true;
    return false;
}

}  // namespace vecino
