// SPDX-License-Identifier: Apache-2.0
//
// A gate's result for programs: JSON, JUnit XML, CTest's tags.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <vector>

#include "core/files.h"
#include "eval/gate_report.h"
#include "eval/html_text.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

const char* outcome_name(GateOutcome outcome) {
    switch (outcome) {
        case GateOutcome::pass:
            return "pass";
        case GateOutcome::fail:
            return "fail";
        case GateOutcome::not_gated:
            break;
    }
    return "not_gated";
}

Json number_or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json verdict_json(const Verdict& v) {
    return {{"outcome", outcome_name(v.outcome)},
            {"rule", v.rule},
            {"class", v.class_name},
            {"group", v.group},
            {"metric", v.metric},
            {"value", number_or_null(v.value)},
            {"value_low", number_or_null(v.value_low)},
            {"value_high", number_or_null(v.value_high)},
            {"baseline", number_or_null(v.baseline)},
            {"limit", number_or_null(v.limit)},
            {v.rule == "time" ? "margin_percent" : "margin_db", number_or_null(v.margin_db)},
            {"noise_db", number_or_null(v.noise_db)},
            {"text", v.text}};
}

/// For XML text and attributes, where control characters cannot stand even as references.
std::string xml(const std::string& text) {
    return escaped(one_line(text));
}

std::string full_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
}

std::string numbers_text(const Verdict& v) {
    std::string text;
    const auto add = [&](const char* name, const std::optional<double>& value) {
        if (value) text += std::string(name) + " " + full_number(*value) + ", ";
    };
    add("value", v.value);
    add("baseline", v.baseline);
    add("limit", v.limit);
    add("margin", v.margin_db);
    return text + v.text;
}

std::string test_case(const GateResult& result, const Verdict& v) {
    const std::string name = v.group + (v.metric.empty() ? "" : " " + v.metric) + " " + v.rule;
    const std::string open = "    <testcase classname=\"" +
                             xml(result.matrix + "." + v.class_name) + "\" name=\"" + xml(name) +
                             "\"";
    const std::string why = xml(numbers_text(v));
    switch (v.outcome) {
        case GateOutcome::fail:
            return open + ">\n      <failure type=\"" + xml(v.rule) + "\" message=\"" + why +
                   "\">" + why + "</failure>\n    </testcase>\n";
        case GateOutcome::not_gated:
            return open + ">\n      <skipped message=\"" + why + "\"/>\n    </testcase>\n";
        case GateOutcome::pass:
            break;
    }
    return open + ">\n      <system-out>" + why + "</system-out>\n    </testcase>\n";
}

std::string counts_text(const std::vector<const Verdict*>& verdicts) {
    const auto count = [&](GateOutcome outcome) {
        return std::to_string(std::ranges::count(verdicts, outcome, &Verdict::outcome));
    };
    return " tests=\"" + std::to_string(verdicts.size()) + "\" failures=\"" +
           count(GateOutcome::fail) + "\" errors=\"0\" skipped=\"" + count(GateOutcome::not_gated) +
           "\"";
}

/// The first cell of a group, with its images.
std::string image_tags(const GateRun& run, const std::string& group_name) {
    const RunGroup* const group = run.find(group_name);
    if (group == nullptr || group->rows.empty()) return "";
    const Json& row = group->rows.front();
    const std::string cell = "cells/" + row.value("cell", "") + "/";
    std::string tags;
    const auto add = [&](const char* name, const std::string& file) {
        const auto path = std::filesystem::absolute(run.directory + "/" + file).lexically_normal();
        if (std::filesystem::exists(path)) tags += ctest_image(name, path.string());
    };
    add("TestImage", cell + "image.png");
    add("ValidImage", row.value("reference_file", "") + ".png");
    add("DifferenceImage2", cell + "error.png");
    return tags;
}

}  // namespace

Json gate_json(const GateResult& result) {
    Json json{{"passed", result.passed()},
              {"matrix", result.matrix},
              {"comparisons", result.count(GateOutcome::pass) + result.count(GateOutcome::fail)},
              {"failed", result.count(GateOutcome::fail)},
              {"not_gated", result.count(GateOutcome::not_gated)},
              {"groups", result.groups},
              {"identical", result.identical},
              {"unused_classes", result.unused},
              {"verdicts", Json::array()}};
    for (const Verdict& verdict : result.verdicts)
        json["verdicts"].push_back(verdict_json(verdict));
    return json;
}

std::string gate_junit(const GateResult& result) {
    std::map<std::string, std::vector<const Verdict*>> suites;
    std::vector<const Verdict*> all;
    for (const Verdict& verdict : result.verdicts) {
        suites[verdict.class_name].push_back(&verdict);
        all.push_back(&verdict);
    }
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"" +
                       xml("vecino check " + result.matrix) + "\"" + counts_text(all) + ">\n";
    for (const auto& [name, verdicts] : suites) {
        text += "  <testsuite name=\"" + xml(name.empty() ? "no class" : name) + "\"" +
                counts_text(verdicts) + ">\n";
        for (const Verdict* verdict : verdicts) text += test_case(result, *verdict);
        text += "  </testsuite>\n";
    }
    return text + "</testsuites>\n";
}

std::string ctest_number(const std::string& name, double value) {
    return "<CTestMeasurement type=\"numeric/double\" name=\"" + xml(name) + "\">" +
           full_number(value) + "</CTestMeasurement>\n";
}

std::string ctest_image(const std::string& name, const std::string& file) {
    return "<CTestMeasurementFile type=\"image/png\" name=\"" + xml(name) + "\">" + xml(file) +
           "</CTestMeasurementFile>\n";
}

std::string gate_ctest(const GateResult& result, const GateRun& run) {
    std::string tags;
    for (const Verdict& v : result.verdicts) {
        if ((v.rule == "mean" || v.rule == "time") && v.value)
            tags += ctest_number(v.group + " " + v.metric, *v.value);
    }
    // One image of each name is all that a test can have: that of the worst verdict.
    for (const Verdict& v : result.verdicts) {
        if (v.outcome != GateOutcome::fail) break;
        const std::string images = image_tags(run, v.group);
        if (!images.empty()) return tags + images;
    }
    return tags;
}

}  // namespace vecino
