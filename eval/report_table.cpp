// SPDX-License-Identifier: Apache-2.0
//
// The results table: one row per group, sorted and filtered by report.js where there is JavaScript.
#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "eval/commands.h"
#include "eval/html_text.h"
#include "eval/metrics.h"
#include "eval/reference_error.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

// Sorts after every number of decibels.
constexpr double kIdentical = 1e9;

struct Value {
    std::string text = "–";
    std::optional<double> number = std::nullopt;  ///< to sort by and to find the best
    std::string interval;
    std::string badge = "";  ///< HTML
};

enum class Better { neither, higher, lower };

struct Column {
    std::string name;
    std::string unit;
    Better better = Better::neither;
    std::function<Value(const GroupSummary&)> value;
};

Value number(double value, int decimals) {
    return {number_text(value, decimals), value, ""};
}

Value estimate(const std::optional<Estimate>& e, int decimals) {
    return e ? number(e->mean, decimals) : Value{};
}

/// A time, or a share of one: 0 stands for none.
Value positive(double value, int decimals) {
    return value > 0 ? number(value, decimals) : Value{};
}

std::string limited_badge() {
    return "<abbr class=\"limited\" title=\"" + escaped(kLimitedFormula) + "\">≈R</abbr>";
}

Value psnr_float(const ReportData& data, const GroupSummary& group) {
    Value value{psnr_float_text(data, group), std::nullopt, psnr_float_interval(group)};
    if (group.psnr_float_db) value.number = group.psnr_float_db->mean;
    if (value.text == "identical") value.number = kIdentical;
    if (group.is_limited == true) value.badge = limited_badge();
    return value;
}

Value region_psnr(const GroupSummary& group, Region region) {
    const std::size_t i = region_index(region);
    Value value = estimate(group.region_psnr_float_db[i], 2);
    if (group.region_is_limited[i] == true) value.badge = limited_badge();
    return value;
}

Value psnr_8bit(const ReportData& data, const GroupSummary& group) {
    if (is_identical(data, group, "psnr_db")) return {"identical", kIdentical, ""};
    return estimate(group.psnr_db, 2);
}

Value parameter(const GroupSummary& group, const std::string& name) {
    Value value{parameter_text(group.params, name), std::nullopt, ""};
    const nlohmann::json json = group.params.value(name, nlohmann::json());
    if (json.is_number()) value.number = json.get<double>();
    return value;
}

Value seeds(const GroupSummary& group) {
    Value value = number(static_cast<double>(group.seeds), 0);
    if (group.failed > 0) value.text += " of " + std::to_string(group.seeds + group.failed);
    return value;
}

std::vector<Column> parameter_columns(const ReportData& data) {
    std::vector<Column> columns;
    for (const std::string& name : data.varying) {
        const std::string unit = name == "window" ? "px" : "";
        columns.push_back({name, unit, Better::neither,
                           [name](const GroupSummary& g) { return parameter(g, name); }});
    }
    columns.push_back({"seeds", "", Better::neither, seeds});
    return columns;
}

/// Of the metrics that some group has, those that the table does not show in a way of its own.
void add_metric_columns(std::vector<Column>& columns, const ReportData& data) {
    for (const MetricInfo& info : all_metrics()) {
        const std::string name(info.name);
        const auto decimals = data.metric_decimals.find(name);
        if (name == "psnr_float_db" || name == "psnr_db" || decimals == data.metric_decimals.end())
            continue;
        columns.push_back({name, info.scale == ErrorScale::decibel ? "dB" : "",
                           info.higher_is_better ? Better::higher : Better::lower,
                           [name, digits = decimals->second](const GroupSummary& g) {
                               const auto found = g.metrics.find(name);
                               return found == g.metrics.end() ? Value{}
                                                               : estimate(found->second, digits);
                           }});
    }
}

/// The parts of relmse, in the decimals of the whole.
void add_relmse_columns(std::vector<Column>& columns, const ReportData& data) {
    const int digits = data.relmse_decimals;
    columns.push_back({"relmse noise", "", Better::lower, [digits](const GroupSummary& g) {
                           return estimate(g.relmse_noise, digits);
                       }});
    columns.push_back({"relmse bias", "", Better::lower, [digits](const GroupSummary& g) {
                           return estimate(g.relmse_bias, digits);
                       }});
}

std::vector<Column> result_columns(const ReportData& data) {
    using Group = const GroupSummary&;
    std::vector<Column> columns = {
        {"psnr_float_db", "dB", Better::higher, [&](Group g) { return psnr_float(data, g); }},
        {"predicted", "dB", Better::neither,
         [](Group g) { return g.predicted_db ? number(*g.predicted_db, 2) : Value{}; }},
        {"interior", "dB", Better::higher,
         [](Group g) { return region_psnr(g, Region::interior); }},
        {"edge", "dB", Better::higher, [](Group g) { return region_psnr(g, Region::edge); }},
        {"emitter", "dB", Better::higher, [](Group g) { return region_psnr(g, Region::emitter); }},
        {"noise", "dB", Better::higher, [](Group g) { return estimate(g.noise_db, 2); }},
        {"bias", "dB", Better::higher, [](Group g) { return estimate(g.bias_db, 2); }},
        {"psnr_db", "dB", Better::higher, [&](Group g) { return psnr_8bit(data, g); }},
    };
    add_metric_columns(columns, data);
    add_relmse_columns(columns, data);
    const std::vector<Column> others = {
        {"time", "s", Better::lower,
         [&](Group g) { return positive(g.time_s, data.time_decimals); }},
        {"time share", "% of path", Better::lower,
         [](Group g) { return positive(100 * g.time_share, 2); }},
        {"fallback", "px", Better::neither,
         [](Group g) {
             return g.seeds > 0 ? number(static_cast<double>(g.fallback_pixels), 0) : Value{};
         }},
        {"dropped", "samples", Better::neither,
         [](Group g) {
             return g.seeds > 0 ? number(static_cast<double>(g.dropped_samples), 0) : Value{};
         }},
    };
    columns.insert(columns.end(), others.begin(), others.end());
    return columns;
}

std::string header_cell(const std::string& name, const std::string& unit, Better better) {
    const char* arrow = better == Better::higher ? " ↑" : better == Better::lower ? " ↓" : "";
    const char* first = better == Better::higher ? " data-first=\"descending\"" : "";
    return "<th scope=\"col\"" + std::string(first) + "><span class=\"name\">" + escaped(name) +
           "</span><span class=\"unit\">" + escaped(unit) + arrow + "</span></th>";
}

std::string data_cell(const Value& value, bool is_best) {
    std::string html = "<td";
    if (value.number) html += " data-value=\"" + number_text(*value.number, 9) + "\"";
    html += is_best ? "><b>" + escaped(value.text) + "</b>" : ">" + escaped(value.text);
    if (!value.interval.empty()) html += "<span class=\"ci\">" + value.interval + "</span>";
    return html + value.badge + "</td>";
}

/// The text of a scene's best value in a column. Texts are compared, so that what reads alike is
/// marked alike.
std::string best_text(const ReportData& data, const std::string& scene, const Column& column) {
    if (column.better == Better::neither) return "";
    Value best;
    for (const GroupSummary& group : data.groups) {
        const bool is_bound = group.method == "blocky_ceiling";  // nothing that one could use
        if (group.scene != scene || is_bound) continue;
        const Value value = column.value(group);
        if (!value.number) continue;
        const bool wins =
            !best.number || (column.better == Better::higher ? *value.number > *best.number
                                                             : *value.number < *best.number);
        if (wins) best = value;
    }
    return best.number ? best.text : "";
}

/// With the words that the filter looks at: not the numbers, which hold any digits.
std::string row_start(const ReportData& data, const GroupSummary& group, bool is_first_of_scene) {
    return "<tr" + std::string(is_first_of_scene ? " class=\"first-of-scene\"" : "") +
           " data-words=\"" + escaped(group.group + " " + parameters_text(data, group)) + "\">";
}

std::string row_head(const ReportData& data, const GroupSummary& group, std::size_t index) {
    const std::string scene = escaped(group.scene);
    return "<td class=\"scene\">" + scene + "</td><th scope=\"row\" data-scene=\"" + scene +
           "\"><a href=\"#g" + std::to_string(index) + "\" title=\"" + escaped(group.group) +
           ": pictures\">" + marker_html(data.style_of(group.method)) + escaped(group.method) +
           "</a></th>";
}

/// Nothing in any row: what images from elsewhere do not have.
bool is_blank(const ReportData& data, const Column& column) {
    return std::ranges::all_of(data.groups, [&](const GroupSummary& group) {
        return column.value(group).text == Value{}.text;
    });
}

using BestTexts = std::map<std::string, std::vector<std::string>>;

BestTexts best_texts(const ReportData& data, const std::vector<Column>& columns) {
    BestTexts texts;
    for (const std::string& scene : data.scenes) {
        for (const Column& column : columns) {
            texts[scene].push_back(best_text(data, scene, column));
        }
    }
    return texts;
}

}  // namespace

std::string psnr_float_text(const ReportData& data, const GroupSummary& group) {
    if (is_identical(data, group, "psnr_float_db")) return "identical";
    return estimate(group.psnr_float_db, 2).text;
}

std::string psnr_float_interval(const GroupSummary& group) {
    const auto& e = group.psnr_float_db;
    if (!e || !e->low) return "";
    if (!e->high) return "≥ " + number_text(*e->low, 2);
    return "± " + number_text(0.5 * (*e->high - *e->low), 2);
}

std::string table_html(const ReportData& data) {
    std::vector<Column> columns = parameter_columns(data);
    for (Column& column : result_columns(data)) columns.push_back(std::move(column));
    std::erase_if(columns, [&](const Column& column) { return is_blank(data, column); });
    const BestTexts best = best_texts(data, columns);

    std::string html = "<table id=\"results-table\"><thead><tr>" +
                       header_cell("scene", "", Better::neither) +
                       header_cell("method", "", Better::neither);
    for (const Column& column : columns) {
        html += header_cell(column.name, column.unit, column.better);
    }
    html += "</tr></thead>\n<tbody>\n";
    std::string scene;
    for (std::size_t i = 0; i < data.groups.size(); ++i) {
        const GroupSummary& group = data.groups[i];
        html += row_start(data, group, group.scene != scene) + row_head(data, group, i);
        scene = group.scene;
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const Value value = columns[c].value(group);
            html += data_cell(value, value.number && value.text == best.at(scene)[c]);
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table>";
}

}  // namespace vecino
