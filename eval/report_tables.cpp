// SPDX-License-Identifier: Apache-2.0
#include "eval/report_tables.h"

#include <algorithm>

#include "eval/csv.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

Json group_json(const GroupSummary& group) {
    Json json = summary_json(group);
    if (!group.times_s.empty()) {
        const auto [least, most] = std::ranges::minmax(group.times_s);
        json["time_s_min"] = least;
        json["time_s_max"] = most;
    }
    return json;
}

}  // namespace

std::string summary_csv(const ReportData& data) {
    std::vector<Json> rows;
    for (const GroupSummary& group : data.groups) {
        rows.push_back(group_json(group));
        rows.back().erase("cells");  // the group's name and the seeds of results.csv say them
    }
    return csv_text(rows, "group");
}

std::string summary_jsonl(const ReportData& data) {
    std::string lines;
    for (const GroupSummary& group : data.groups) lines += group_json(group).dump() + "\n";
    return lines;
}

}  // namespace vecino
