// SPDX-License-Identifier: Apache-2.0
#include "eval/report_facts.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <set>

namespace vecino {
namespace {

using Json = nlohmann::json;

std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// The different values of a key of all rows, as a list.
std::string values_of(const ReportData& data, const char* key) {
    std::vector<std::string> values;
    for (const Json& row : data.rows) {
        if (!row.contains(key)) continue;
        const std::string text = text_of(row[key]);
        if (std::ranges::find(values, text) == values.end()) values.push_back(text);
    }
    std::string list;
    for (const std::string& value : values) list += (list.empty() ? "" : ", ") + value;
    return list.empty() ? "unknown" : list;
}

std::string when(const ReportData& data) {
    std::string date = data.run.value("finished_utc", "");
    if (date.size() != 20) return "not finished";
    return date.replace(10, 1, " ").substr(0, 16) + " UTC";
}

std::string program(const ReportData& data) {
    const Json versions = data.run.value("versions", Json::object());
    const std::string commit = versions.value("commit", "");
    return "vecino " + versions.value("vecino", "of unknown version") +
           (commit.empty() ? "" : ", commit " + commit);
}

/// "33.5 x 10^9 samples in 35.2 min"; of runs that did not say, nothing.
std::string work(const ReportData& data) {
    const double samples = data.run.value("samples", 0.0);
    const double seconds = data.run.value("seconds", 0.0);
    if (!(samples > 0)) return "unknown";
    char text[96];
    std::snprintf(text, sizeof text, "%.4g million samples in %.3g min", samples * 1e-6,
                  seconds / 60);
    return text;
}

/// Seeds by the spp that was asked for: "1 (10000 spp); 1, 2, 3, 4 (1000 spp)".
std::string seeds(const ReportData& data) {
    std::map<std::vector<std::uint32_t>, std::set<int, std::greater<>>> by_seeds;
    for (const GroupSummary& group : data.groups) {
        if (group.method == "blocky_ceiling") continue;
        auto& counts = by_seeds[group.seeds_done];
        if (group.params.contains("spp_asked")) counts.insert(group.params["spp_asked"].get<int>());
    }
    std::string text;
    for (const auto& [list, counts] : by_seeds) {
        std::string numbers;
        for (const std::uint32_t seed : list)
            numbers += (numbers.empty() ? "" : ", ") + std::to_string(seed);
        std::string spp;
        for (const int count : counts) spp += (spp.empty() ? "" : ", ") + std::to_string(count);
        text += (text.empty() ? "" : "; ") + (numbers.empty() ? "none" : numbers);
        if (by_seeds.size() > 1 && !spp.empty()) text += " at " + spp + " spp";
    }
    return text;
}

/// Every library and tool of the run by name and version.
std::string libraries(const ReportData& data) {
    std::string text;
    const Json versions = data.run.value("versions", Json::object());
    const std::set<std::string> apart{"vecino", "commit", "cpu", "threads", "simd_width", "build"};
    for (const auto& [name, version] : versions.items()) {
        if (apart.contains(name)) continue;
        text += (text.empty() ? "" : ", ") + name + " " + text_of(version);
    }
    return text.empty() ? "unknown" : text;
}

std::size_t expected_refusals(const ReportData& data) {
    return static_cast<std::size_t>(std::ranges::count_if(
        data.rows, [&](const Json& row) { return is_expected_refusal(row, data.failures.cases); }));
}

std::string cells(const ReportData& data) {
    const std::size_t planned = data.run.value("cells", data.rows.size());
    const std::size_t refused = expected_refusals(data);
    const std::size_t failed = failed_rows(data) - refused;
    std::string text = std::to_string(data.rows.size());
    if (planned > data.rows.size()) text += " of " + std::to_string(planned) + " so far";
    text += " in " + counted(data.groups.size(), "group");
    text += failed == 0 ? "; none failed" : "; " + std::to_string(failed) + " failed";
    return text + (refused == 0 ? "" : "; " + std::to_string(refused) + " refused, as expected");
}

/// Parameters with one value in the whole matrix.
std::string fixed_parameters(const ReportData& data) {
    const std::set<std::string> apart{"scene", "method", "image", "seed", "spp_asked"};
    std::string text;
    for (const auto& [key, value] : data.groups.front().params.items()) {
        const bool varies = std::ranges::find(data.varying, key) != data.varying.end();
        if (varies || apart.contains(key)) continue;
        text += (text.empty() ? "" : ", ") + key + " " +
                parameter_text(data.groups.front().params, key);
    }
    return text;
}

std::string references(const ReportData& data) {
    std::vector<std::string> texts;
    for (const Json& row : data.rows) {
        const std::string text = reference_text(row);
        if (std::ranges::find(texts, text) == texts.end()) texts.push_back(text);
    }
    std::string all;
    for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
    return all;
}

}  // namespace

std::string text_of(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

std::size_t failed_rows(const ReportData& data) {
    const auto failed = [](const Json& row) { return row["status"] != "ok"; };
    return static_cast<std::size_t>(std::ranges::count_if(data.rows, failed));
}

std::vector<Fact> run_facts(const ReportData& data) {
    const Json versions = data.run.value("versions", Json::object());
    const std::string simd = text_of(versions.value("simd_width", Json("unknown")));
    std::vector<Fact> facts = {
        {"Finished", when(data)},
        {"Program", program(data)},
        {"Libraries", libraries(data)},
        {"Processor", values_of(data, "host")},
        {"Threads", values_of(data, "threads") + "; " + simd + " samples side by side"},
        {"Cells", cells(data)},
        {"Work", work(data)},
        {"Seeds", seeds(data)},
        {"In all cells", fixed_parameters(data)},
        {"Reference", references(data)}};
    std::erase_if(facts, [](const Fact& fact) { return fact.value.empty(); });
    return facts;
}

}  // namespace vecino
