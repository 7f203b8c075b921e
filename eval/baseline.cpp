// SPDX-License-Identifier: Apache-2.0
#include "eval/baseline.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/json_read.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

constexpr int kFormat = 1;

/// Nine digits: more than noise leaves, also of what is left of a similarity near 1.
std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
}

double rounded(double value) {
    return std::stod(number(value));
}

std::string quoted(const std::string& text) {
    return Json(text).dump();
}

std::string numbers_line(const BaselineGroup& group) {
    std::string line = "{\"seeds\": " + std::to_string(group.seeds);
    const auto add = [&](const std::string& name, const MetricSpread& spread) {
        line += ", " + quoted(name) + ": [" + number(spread.mean) + ", " +
                number(spread.deviation) + "]";
    };
    for (const auto& [name, spread] : group.metrics) add(name, spread);
    if (group.time_s.mean > 0) add("time_s", group.time_s);
    return line + "}";
}

/// Members of an object, one per line.
template <class LineOf>
std::string members(const Baseline& baseline, LineOf line_of) {
    std::string text;
    for (const auto& [name, group] : baseline.groups)
        text += (text.empty() ? "  " : ",\n  ") + quoted(name) + ": " + line_of(group);
    return "{\n" + text + "\n }";
}

MetricSpread read_spread(const JsonValue& json) {
    const auto numbers = json.elements();
    if (numbers.size() != 2) json.fail("[mean, standard deviation]");
    return {numbers[0].number(), numbers[1].number({0.0, 1e30})};
}

BaselineGroup read_group(const JsonValue& json) {
    BaselineGroup group;
    group.seeds =
        static_cast<std::size_t>(json.at("seeds").integer(1, std::numeric_limits<int>::max()));
    for (const auto& [name, value] : json.members()) {
        if (name == "seeds") continue;
        if (name == "time_s") {
            group.time_s = read_spread(value);
        } else if (find_gate_metric(name)) {
            group.metrics[name] = read_spread(value);
        } else {
            json.fail("\"" + name + "\"", "seeds, time_s and metrics, as \"edge.psnr_float_db\"");
        }
    }
    return group;
}

}  // namespace

// Time and host play no part: they change with every run.
bool operator==(const BaselineGroup& a, const BaselineGroup& b) {
    const auto same = [](const MetricSpread& x, const MetricSpread& y) {
        return x.mean == y.mean && x.deviation == y.deviation;
    };
    return a.seeds == b.seeds && a.question == b.question && a.metrics.size() == b.metrics.size() &&
           std::equal(a.metrics.begin(), a.metrics.end(), b.metrics.begin(),
                      [&](const auto& x, const auto& y) {
                          return x.first == y.first && same(x.second, y.second);
                      });
}

Baseline read_baseline(const std::string& path) {
    const Json document = parse_json_file(path);
    const JsonValue json(document, path);
    json.require_keys({"format", "matrix", "groups", "questions"});
    (void)json.at("format").integer(kFormat, kFormat);
    Baseline baseline;
    baseline.matrix = json.at("matrix").string();
    for (const auto& [name, value] : json.at("groups").members())
        baseline.groups[name] = read_group(value);
    for (const auto& [name, value] : json.at("questions").members()) {
        const auto group = baseline.groups.find(name);
        if (group == baseline.groups.end()) value.fail("a group that \"groups\" holds");
        value.require_keys({"host", "asked"});
        group->second.host = value.at("host").string();
        group->second.question = value.at("asked").raw();
    }
    for (const auto& [name, group] : baseline.groups)
        if (group.question.is_null()) (void)json.at("questions").at(name);
    return baseline;
}

void write_baseline(const std::string& path, const Baseline& baseline) {
    const auto question = [](const BaselineGroup& group) {
        return "{\"host\": " + quoted(group.host) + ", \"asked\": " + group.question.dump() + "}";
    };
    write_text_file(path, "{\n \"format\": " + std::to_string(kFormat) +
                              ",\n \"matrix\": " + quoted(baseline.matrix) +
                              ",\n \"groups\": " + members(baseline, numbers_line) +
                              ",\n \"questions\": " + members(baseline, question) + "\n}\n");
}

MetricSpread time_spread(const std::vector<double>& times_s) {
    if (times_s.empty()) return {};
    std::vector<double> logarithms;
    for (const double time : times_s) logarithms.push_back(std::log(time));
    const auto n = static_cast<double>(logarithms.size());
    double mean = 0;
    for (const double each : logarithms) mean += each / n;
    double squares = 0;
    for (const double each : logarithms) squares += (each - mean) * (each - mean);
    return {std::exp(mean), logarithms.size() < 2 ? 0 : std::sqrt(squares / (n - 1))};
}

BaselineGroup baseline_of(const RunGroup& group, const GateClass& gate) {
    BaselineGroup result;
    result.seeds = group.rows.size();
    for (const auto& [metric, tolerance] : gate.tolerance_db) {
        const auto errors = group.errors(metric);
        if (!errors) continue;
        const MetricSpread spread = spread_over_seeds(*metric.info, *errors);
        result.metrics[metric.name] = {rounded(spread.mean), rounded(spread.deviation)};
    }
    const MetricSpread time = time_spread(group.times_s());
    result.time_s = {rounded(time.mean), rounded(time.deviation)};
    result.host = group.host();
    result.question = group.question;
    return result;
}

}  // namespace vecino
