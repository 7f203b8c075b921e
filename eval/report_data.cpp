// SPDX-License-Identifier: Apache-2.0
#include "eval/report_data.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "eval/group_statistics.h"
#include "eval/metrics.h"
#include "eval/run_directory.h"
#include "filters/methods.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kPathShape = "crossRot";
constexpr std::string_view kShapes[] = {"rect",         "triangle", "rectRot", "circle",
                                        "triangleDown", "star",     "cross"};
constexpr const char* kCeiling = "blocky_ceiling";
constexpr std::string_view kCeilingShape = "line";
constexpr int kColours = 8;

void require_row(const Json& row, const std::string& file) {
    const auto fail = [&](const std::string& what) {
        throw Error(ExitCode::file,
                    file + ": row of cell " + row["cell"].get<std::string>() + " lacks " + what);
    };
    for (const char* key : {"group", "scene", "method", "status"}) {
        if (!row.contains(key) || !row[key].is_string()) fail(key);
    }
    if (!row.value("params", Json()).is_object()) fail("params");
    if (row["status"] != "ok") return;
    for (const char* key : {"metrics", "counts", "time_s"}) {
        if (!row.value(key, Json()).is_object()) fail(key);
    }
    for (const char* key : {"reconstruct", "total"}) {
        if (!row["time_s"].value(key, Json()).is_number()) fail(std::string("time_s.") + key);
    }
}

/// Cells in the order in which they first stand in the file: that of the matrix.
std::vector<std::string> cell_order(const std::string& text) {
    std::vector<std::string> order;
    std::set<std::string> known;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        const Json row = Json::parse(line, nullptr, false);
        if (!row.is_object() || !row.value("cell", Json()).is_string()) continue;
        if (known.insert(row["cell"]).second) order.push_back(row["cell"]);
    }
    return order;
}

void read_rows(ReportData& data) {
    const RunDirectory directory = RunDirectory::open(data.directory);
    const std::string file = directory.file("results.jsonl");
    auto rows = directory.rows();
    for (const std::string& cell : cell_order(read_file(file))) {
        require_row(rows.at(cell), file);
        data.row.emplace(cell, data.rows.size());
        data.rows.push_back(std::move(rows.at(cell)));
    }
    if (data.rows.empty()) throw Error(ExitCode::file, file + ": holds no results");
}

Json read_run(const std::string& path) {
    // A first run that was killed has results, but no run.json.
    if (!std::filesystem::exists(path)) return Json::object();
    Json run = Json::parse(read_file(path), nullptr, false);
    if (!run.is_object()) throw Error(ExitCode::file, path + ": is not a JSON object");
    return run;
}

/// One that the fewest of the others have.
int rarest_colour(const std::vector<MethodStyle>& styles) {
    int count[kColours + 1] = {};
    for (const MethodStyle& style : styles) ++count[style.colour];
    return static_cast<int>(std::min_element(count + 1, std::end(count)) - count);
}

std::vector<MethodStyle> method_styles(const std::vector<GroupSummary>& groups) {
    std::vector<std::string> names;
    for (const Scheme& scheme : all_schemes()) names.emplace_back(scheme.name);
    for (const Method& method : all_methods()) {
        if (method.name != "path") names.emplace_back(method.name);
    }
    std::set<std::string> used;
    for (const GroupSummary& group : groups) {
        used.insert(group.method);
        const bool known = std::ranges::find(names, group.method) != names.end();
        const bool is_special = group.method == "path" || group.method == kCeiling;
        if (!known && !is_special) names.push_back(group.method);
    }
    // A scheme keeps its looks whichever others a run holds; others get what is left.
    std::vector<MethodStyle> styles;
    if (used.contains("path")) styles.push_back({"path", kPathShape, 0});
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!used.contains(names[i])) continue;
        const bool is_scheme = i < all_schemes().size();
        const int colour = is_scheme ? static_cast<int>(i % kColours) + 1 : rarest_colour(styles);
        styles.push_back({names[i], kShapes[i % std::size(kShapes)], colour});
    }
    if (used.contains(kCeiling)) styles.push_back({kCeiling, kCeilingShape, 0});
    return styles;
}

/// Reduction and window always, then whatever has more than one value among the groups.
std::vector<std::string> varying_parameters(const std::vector<GroupSummary>& groups) {
    std::map<std::string, std::set<Json>> values;
    for (const GroupSummary& group : groups) {
        for (const auto& [key, value] : group.params.items()) values[key].insert(value);
    }
    std::vector<std::string> names{"reduction", "window"};
    const std::set<std::string> apart{"scene",  "method",    "image",    "seed",
                                      "window", "reduction", "spp_asked"};
    for (const auto& [key, different] : values) {
        if (different.size() > 1 && !apart.contains(key)) names.push_back(key);
    }
    return names;
}

int decimals_for(double least, int digits) {
    if (!(least > 0)) return 3;
    return std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(least))), 1, 7);
}

int decimals_of(ErrorScale scale, double least) {
    if (scale == ErrorScale::decibel) return 2;
    return scale == ErrorScale::similarity ? 4 : decimals_for(least, 2);
}

void set_decimals(ReportData& data) {
    double least_time = 0;
    double least_relmse = 0;
    const auto lower = [](double& least, double value) {
        if (value > 0 && (least == 0 || value < least)) least = value;
    };
    for (const GroupSummary& group : data.groups) {
        lower(least_time, group.time_s);
        if (group.relmse) lower(least_relmse, group.relmse->mean);
    }
    for (const MetricInfo& info : all_metrics()) {
        const std::string name(info.name);
        double least = 0;
        bool is_there = false;
        for (const GroupSummary& group : data.groups) {
            const auto found = group.metrics.find(name);
            if (found == group.metrics.end()) continue;
            is_there = true;
            lower(least, found->second.mean);
        }
        if (is_there) data.metric_decimals[name] = decimals_of(info.scale, least);
    }
    data.time_decimals = decimals_for(least_time, 3);
    data.relmse_decimals = decimals_for(least_relmse, 2);
}

/// Before claims are judged, which may be about signatures.
void read_failures_of(ReportData& data) {
    const Json config = data.run.value("config", Json::object());
    if (!config.is_object()) return;
    data.failures =
        failure_results(data.directory, data.rows, JsonValue(config, data.directory + "/run.json"));
    for (GroupSummary& group : data.groups) {
        const FailureResult* const result = data.failures.find(group.group);
        if (result == nullptr) continue;
        // What passes by far is the same as none: ratios would make much of it.
        const double least = 0.1 * data.failures.cases[result->failure].pass_below;
        for (const double value : result->by_seed)
            group.signature_by_seed.push_back(std::max(value, least));
    }
}

/// The claims stand in the matrix that run.json keeps.
void read_reproduction_of(ReportData& data) {
    const Json config = data.run.value("config", Json::object());
    if (!config.is_object() || !config.contains("reproduction")) return;
    ReportReproduction found;
    found.specification = read_reproduction(JsonValue(config, data.directory + "/run.json"));
    found.result = evaluate(found.specification, data.groups);
    data.reproduction = std::move(found);
}

}  // namespace

const MethodStyle& ReportData::style_of(const std::string& method) const {
    return *std::ranges::find(methods, method, &MethodStyle::method);
}

ReportData read_report_data(const std::string& directory) {
    ReportData data;
    data.directory = directory;
    read_rows(data);
    data.run = read_run(directory + "/run.json");
    data.groups =
        summarise(data.rows, group_statistics(RunDirectory::open(data.directory), data.rows));
    for (const auto& [name, stability] :
         group_stability(RunDirectory::open(data.directory), data.rows)) {
        std::ranges::find(data.groups, name, &GroupSummary::group)->stability = stability;
    }
    read_failures_of(data);
    read_reproduction_of(data);
    data.convergence = convergence(data.groups);
    for (const GroupSummary& group : data.groups) {
        const bool is_new = std::ranges::find(data.scenes, group.scene) == data.scenes.end();
        if (is_new) data.scenes.push_back(group.scene);
    }
    data.methods = method_styles(data.groups);
    data.varying = varying_parameters(data.groups);
    set_decimals(data);
    return data;
}

void write_reproduction(const ReportData& data) {
    if (!data.reproduction) return;
    const Json json =
        reproduction_json(data.reproduction->specification, data.reproduction->result);
    write_text_file(data.directory + "/reproduction.json", json.dump(1) + "\n");
}

void write_failures(const ReportData& data) {
    if (data.failures.cases.empty()) return;
    write_text_file(data.directory + "/failures.json", failures_json(data.failures).dump(1) + "\n");
}

std::vector<std::size_t> variants_of(const ReportData& data, const GroupSummary& group) {
    std::vector<std::size_t> indices;
    if (!data.reproduction) return indices;
    const auto& variants = data.reproduction->specification.variants;
    for (std::size_t i = 0; i < variants.size(); ++i) {
        if (Selection().matches(group.params, variants[i].where.without("spp")))
            indices.push_back(i);
    }
    return indices;
}

std::size_t index_of(const ReportData& data, const GroupSummary& group) {
    const auto found = std::ranges::find(data.groups, group.group, &GroupSummary::group);
    return static_cast<std::size_t>(found - data.groups.begin());
}

std::string parameter_text(const Json& params, const std::string& name) {
    const Json value = params.value(name, Json());
    if (value.is_null()) return "–";
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump();
    std::string text;
    for (const Json& each : value) text += (text.empty() ? "" : " × ") + each.dump();
    return text;
}

std::string parameters_text(const ReportData& data, const GroupSummary& group) {
    std::string text;
    for (const std::string& name : data.varying) {
        if (!group.params.contains(name)) continue;
        text += (text.empty() ? "" : ", ") + name + " " + parameter_text(group.params, name);
    }
    return text;
}

std::string reference_text(const Json& row) {
    const Json settings = row.value("reference", Json::object());
    std::string text;
    if (settings.contains("source")) return "file " + settings["source"].value("file", "");
    for (const char* name : {"spp", "light_sampling", "sampler", "seed"}) {
        if (!settings.contains(name)) continue;
        text +=
            (text.empty() ? "" : ", ") + std::string(name) + " " + parameter_text(settings, name);
    }
    return text;
}

std::string short_name(const GroupSummary& group) {
    const std::string prefix = group.scene + ".";
    return group.group.starts_with(prefix) ? group.group.substr(prefix.size()) : group.group;
}

bool is_identical(const ReportData& data, const GroupSummary& group, const std::string& metric) {
    if (group.seeds == 0) return false;
    return std::ranges::all_of(group.cells, [&](const std::string& cell) {
        const Json& row = data.row_of(cell);
        return row["status"] != "ok" || row["metrics"].value(metric, Json(0)).is_null();
    });
}

}  // namespace vecino
