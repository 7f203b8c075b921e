// SPDX-License-Identifier: Apache-2.0
#include "eval/failure_results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <set>

#include "core/error.h"
#include "core/image_io.h"
#include "core/parallel.h"
#include "eval/matrix.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

/// Cells that differ in their seed alone.
struct Group {
    FailureResult result;
    std::vector<Json> rows;
    std::vector<std::string> path;  ///< cells of path tracing by the same seeds
    std::string reference;
};

std::string text_at(const Json& row, const char* key) {
    const Json value = row.value(key, Json());
    return value.is_string() ? value.get<std::string>() : "";
}

bool is_refused(const Json& row) {
    return text_at(row, "status") == "refused";
}

double mean_of(const SignatureValues& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

class Reader {
  public:
    Reader(const std::string& directory, const std::vector<Json>& rows, Failures& failures)
        : directory_(directory), rows_(rows), failures_(failures) {
        for (std::size_t i = 0; i < failures.cases.size(); ++i)
            by_scene_[stem(failures.cases[i].scene)] = i;
    }

    void run() {
        find_groups();
        for (const Group& group : groups_) load_reference(group.reference);
        for_each_block(groups_.size(), 1, 0, [&](BlockRange block) {
            for (std::size_t i = block.begin; i < block.end; ++i) judge(groups_[i]);
        });
        for (Group& group : groups_) failures_.results.push_back(std::move(group.result));
    }

  private:
    void find_groups() {
        std::map<std::string, std::size_t> index;
        for (const Json& row : rows_) {
            const auto found = by_scene_.find(text_at(row, "scene"));
            if (found == by_scene_.end()) continue;
            const FailureCase& failure = failures_.cases[found->second];
            if (!failure.is_for(row.value("params", Json::object()))) continue;
            const auto [entry, is_new] = index.try_emplace(text_at(row, "group"), groups_.size());
            if (is_new) groups_.push_back(group_of(row, found->second));
            Group& group = groups_[entry->second];
            group.rows.push_back(row);
            group.path.push_back(text_at(row, "against") + ".s" + row.value("seed", Json()).dump());
        }
    }

    [[nodiscard]] Group group_of(const Json& row, std::size_t failure) const {
        Group group;
        group.result.group = text_at(row, "group");
        group.result.failure = failure;
        group.result.method = text_at(row, "method");
        group.result.params = row.value("params", Json::object());
        const Expectation* const expected = failures_.cases[failure].expected(group.result.params);
        if (expected != nullptr) {
            group.result.expected = expected->verdicts;
            group.result.why = expected->why;
        }
        group.reference = text_at(row, "reference_file");
        return group;
    }

    void load_reference(const std::string& file) {
        const std::string path = directory_ + "/" + file + ".exr";
        if (file.empty() || references_.contains(file) || !std::filesystem::exists(path)) return;
        references_.emplace(file, load_frame(path));
    }

    [[nodiscard]] Image image_of(const std::string& cell) const {
        return load_image(directory_ + "/cells/" + cell + "/image.exr");
    }

    void judge(Group& group) const {
        const FailureCase& failure = failures_.cases[group.result.failure];
        try {
            measure(group, failure);
        } catch (const Error& error) {
            group.result.reason = error.what();
        }
        FailureResult& result = group.result;
        const double nan = std::numeric_limits<double>::quiet_NaN();
        result.verdict = std::ranges::all_of(group.rows, is_refused)
                             ? FailureVerdict::refuses
                             : failure.verdict(result.value.value_or(nan));
    }

    void measure(Group& group, const FailureCase& failure) const {
        for (const Json& row : group.rows) {
            if (text_at(row, "status") == "ok") continue;
            group.result.reason = row.value("reason", "failed");
            return;
        }
        const auto reference = references_.find(group.reference);
        if (reference == references_.end())
            throw Error(ExitCode::file, "found no reference image, allowed: with it");
        std::vector<Image> images, path;
        for (const Json& row : group.rows) images.push_back(image_of(text_at(row, "cell")));
        for (const std::string& cell : group.path) {
            if (!std::filesystem::exists(directory_ + "/cells/" + cell + "/image.exr")) continue;
            path.push_back(image_of(cell));
        }
        const auto values = [&](const Measure& each) {
            return measured(each, {images, path, group.rows, reference->second, each.parameters});
        };
        group.result.by_seed = values(failure.measure);
        group.result.value = mean_of(group.result.by_seed);
        for (const Measure& each : failure.also) group.result.also.push_back(mean_of(values(each)));
    }

    const std::string& directory_;
    const std::vector<Json>& rows_;
    Failures& failures_;
    std::map<std::string, std::size_t> by_scene_;
    std::vector<Group> groups_;
    std::map<std::string, Frame> references_;
};

bool is_worse(const FailureResult* a, const FailureResult* b) {
    const double most = std::numeric_limits<double>::infinity();
    return a->value.value_or(most) > b->value.value_or(most);
}

/// Parameters of results that differ within one scene and method, and are no size or seed.
std::set<std::string> telling_parameters(const Failures& failures, const std::string& method) {
    static const std::set<std::string> kApart{"scene",  "method", "seed",     "reduction",
                                              "window", "size",   "spp",      "spp_asked",
                                              "inject", "image",  "max_depth"};
    std::map<std::string, std::map<std::size_t, std::set<Json>>> values;
    for (const FailureResult& result : failures.results) {
        if (result.method != method) continue;
        for (const auto& [key, value] : result.params.items())
            if (!kApart.contains(key)) values[key][result.failure].insert(value);
    }
    std::set<std::string> names;
    for (const auto& [key, by_case] : values) {
        const bool differs =
            std::ranges::any_of(by_case, [](const auto& entry) { return entry.second.size() > 1; });
        if (differs) names.insert(key);
    }
    return names;
}

std::string plain_text(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace

bool FailureResult::is_unexpected() const {
    const bool is_refusal = verdict == FailureVerdict::refuses;
    if (!value && !is_refusal) return true;
    return (is_refusal || !expected.empty()) &&
           std::ranges::find(expected, verdict) == expected.end();
}

const FailureResult* Failures::find(const std::string& group) const {
    const auto found = std::ranges::find(results, group, &FailureResult::group);
    return found == results.end() ? nullptr : &*found;
}

bool is_expected_refusal(const Json& row, const std::vector<FailureCase>& failures) {
    if (!is_refused(row)) return false;
    const auto failure = std::ranges::find_if(failures, [&](const FailureCase& each) {
        return stem(each.scene) == text_at(row, "scene");
    });
    if (failure == failures.end()) return false;
    const Expectation* const expected = failure->expected(row.value("params", Json::object()));
    return expected != nullptr && std::ranges::find(expected->verdicts, FailureVerdict::refuses) !=
                                      expected->verdicts.end();
}

Failures failure_results(const std::string& directory, const std::vector<Json>& rows,
                         const JsonValue& matrix) {
    Failures failures;
    if (!matrix.has("failures")) return failures;
    for (const JsonValue& each : matrix.at("failures").elements())
        failures.cases.push_back(read_failure(each));
    Reader(directory, rows, failures).run();
    return failures;
}

std::vector<FailureMethod> failure_methods(const Failures& failures) {
    std::vector<FailureMethod> methods;
    std::map<std::string, std::set<std::string>> telling;
    for (const FailureResult& result : failures.results) {
        if (!telling.contains(result.method))
            telling.emplace(result.method, telling_parameters(failures, result.method));
        std::string label = result.method;
        for (const std::string& key : telling.at(result.method))
            if (result.params.contains(key)) label += ", " + plain_text(result.params[key]);
        auto found = std::ranges::find(methods, label, &FailureMethod::label);
        if (found == methods.end()) {
            methods.push_back({label, result.method, {}});
            methods.back().by_case.resize(failures.cases.size());
            found = std::prev(methods.end());
        }
        found->by_case[result.failure].push_back(&result);
    }
    for (FailureMethod& method : methods)
        for (auto& results : method.by_case) std::ranges::stable_sort(results, is_worse);
    return methods;
}

std::string variant_text(const Json& params) {
    std::string text;
    const auto add = [&](const char* key, const char* sign) {
        if (!params.contains(key)) return;
        text += (text.empty() ? "" : " ") + std::string(sign) + params[key].dump();
    };
    add("reduction", "f");
    add("window", "w");
    return text;
}

std::string failure_number(const std::optional<double>& value) {
    if (!value) return "–";
    if (std::isinf(*value)) return "∞";
    char text[32];
    const double size = std::abs(*value);
    if (size == 0) return "0";
    if (size < 0.001 || size >= 10000)
        std::snprintf(text, sizeof text, "%.1e", *value);
    else
        std::snprintf(text, sizeof text, "%.*f",
                      size < 1     ? 3
                      : size < 10  ? 2
                      : size < 100 ? 1
                                   : 0,
                      *value);
    return text;
}

Json failures_json(const Failures& failures) {
    Json rows = Json::array();
    for (const FailureResult& result : failures.results) {
        const FailureCase& failure = failures.cases[result.failure];
        const bool is_number = result.value && std::isfinite(*result.value);
        Json row{{"failure", failure.id},
                 {"scene", stem(failure.scene)},
                 {"signature", failure.measure.signature->name},
                 {"unit", failure.measure.signature->unit},
                 {"group", result.group},
                 {"method", result.method},
                 {"value", is_number ? Json(*result.value) : Json()},
                 {"pass_below", failure.pass_below},
                 {"fails_above", failure.fails_above},
                 {"verdict", verdict_name(result.verdict)},
                 {"unexpected", result.is_unexpected()}};
        if (!result.reason.empty()) row["reason"] = result.reason;
        row["expected"] = Json::array();
        for (const FailureVerdict verdict : result.expected)
            row["expected"].push_back(verdict_name(verdict));
        for (std::size_t i = 0; i < result.also.size(); ++i)
            row["also"][std::string(failure.also[i].signature->name)] = *result.also[i];
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace vecino
