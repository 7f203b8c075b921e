// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "eval/commands.h"
#include "eval/report_tables.h"

namespace vecino {
namespace {

constexpr std::size_t kPageRows = 45;  // a table with more goes over pages

// Beside ASCII what our own texts hold; other letters are passed on.
// clang-format off
const std::map<std::string_view, std::string_view> kCommands{
    {"\\", "\\textbackslash{}"}, {"{", "\\{"},           {"}", "\\}"},                 {"$", "\\$"},
    {"&", "\\&"},                 {"#", "\\#"},           {"%", "\\%"},                 {"_", "\\_"},
    {"^", "\\textasciicircum{}"}, {"~", "\\textasciitilde{}"}, {"<", "\\textless{}"},   {">", "\\textgreater{}"},
    {"|", "\\textbar{}"},         {"\"", "\\char34{}"},   {"`", "\\textasciigrave{}"},  {"'", "\\textquotesingle{}"},
    {"–", "--"},                   {"×", "$\\times$"},     {"±", "$\\pm$"},               {"−", "$-$"},
    {"≥", "$\\geq$"},
};
// clang-format on

enum class Better { neither, higher, lower };

/// Text is LaTeX already.
struct Value {
    std::string text = "--";
    std::optional<double> number = std::nullopt;
};

struct Column {
    std::string head;
    char alignment;
    Better better;
    std::function<Value(const GroupSummary&)> value;
};

std::string interval(const Estimate& e, int decimals) {
    if (!e.low) return "";
    if (!e.high) return " ($\\geq$ " + number_text(*e.low, decimals) + ")";
    return " $\\pm$ " + number_text(0.5 * (*e.high - *e.low), decimals);
}

Value estimate(const std::optional<Estimate>& e, int decimals) {
    if (!e) return {};
    return {number_text(e->mean, decimals) + interval(*e, decimals), e->mean};
}

Value positive(double value, int decimals, const char* unit = "") {
    if (!(value > 0)) return {};
    return {number_text(value, decimals) + unit, value};
}

Value psnr_float(const ReportData& data, const GroupSummary& group) {
    if (is_identical(data, group, "psnr_float_db")) return {"identical"};
    return estimate(group.psnr_float_db, 2);
}

/// Parameters that have more than one value among the groups.
std::vector<std::string> varying_among(const ReportData& data,
                                       const std::vector<const GroupSummary*>& groups) {
    std::vector<std::string> names;
    for (const std::string& name : data.varying) {
        std::set<std::string> values;
        for (const GroupSummary* group : groups) values.insert(parameter_text(group->params, name));
        if (values.size() > 1) names.push_back(name);
    }
    return names;
}

std::vector<Column> columns_of(const ReportData& data,
                               const std::vector<const GroupSummary*>& groups) {
    using Group = const GroupSummary&;
    std::vector<Column> columns{{"method", 'l', Better::neither, [](Group g) {
                                     return Value{"\\texttt{" + latex_text(g.method) + "}"};
                                 }}};
    for (const std::string& name : varying_among(data, groups)) {
        columns.push_back({latex_text(name), 'r', Better::neither, [name](Group g) {
                               return Value{latex_text(parameter_text(g.params, name))};
                           }});
    }
    const std::vector<Column> results{
        {"seeds", 'r', Better::neither, [](Group g) { return Value{std::to_string(g.seeds)}; }},
        {"PSNR, dB", 'r', Better::higher, [&](Group g) { return psnr_float(data, g); }},
        {"interior, dB", 'r', Better::higher,
         [](Group g) {
             return estimate(g.region_psnr_float_db[region_index(Region::interior)], 2);
         }},
        {"SSIM", 'r', Better::higher, [](Group g) { return estimate(g.ssim, 4); }},
        {"relMSE", 'r', Better::lower,
         [&](Group g) { return estimate(g.relmse, data.relmse_decimals); }},
        {"time, s", 'r', Better::lower,
         [&](Group g) { return positive(g.time_s, data.time_decimals); }},
        {"share", 'r', Better::lower,
         [](Group g) { return positive(100 * g.time_share, 1, "\\,\\%"); }},
    };
    columns.insert(columns.end(), results.begin(), results.end());
    return columns;
}

/// A ceiling is no method that one could choose.
bool competes(const GroupSummary& group) {
    return group.params.contains("spp");
}

/// The best number of a column; all that read the same are as good.
std::optional<std::string> best_text(const Column& column,
                                     const std::vector<const GroupSummary*>& groups) {
    std::optional<Value> best;
    for (const GroupSummary* group : groups) {
        const Value value = column.value(*group);
        if (!value.number || !competes(*group)) continue;
        const bool is_better =
            !best || (column.better == Better::higher ? *value.number > *best->number
                                                      : *value.number < *best->number);
        if (is_better) best = value;
    }
    return best ? std::optional(best->text) : std::nullopt;
}

std::string line(const std::vector<std::string>& cells) {
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) text += (i == 0 ? "" : " & ") + cells[i];
    return text + " \\\\\n";
}

std::string body(const std::vector<Column>& columns,
                 const std::vector<const GroupSummary*>& groups) {
    std::vector<std::optional<std::string>> best;
    for (const Column& column : columns) {
        const bool is_ranked = column.better != Better::neither && groups.size() > 1;
        best.push_back(is_ranked ? best_text(column, groups) : std::nullopt);
    }
    std::string text;
    for (const GroupSummary* group : groups) {
        std::vector<std::string> cells;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const Value value = columns[i].value(*group);
            const bool is_best = value.number && value.text == best[i] && competes(*group);
            cells.push_back(is_best ? "\\textbf{" + value.text + "}" : value.text);
        }
        text += line(cells);
    }
    return text;
}

std::string caption(const ReportData& data, const std::string& scene) {
    const std::string name = data.run.value("name", "results");
    // Letters, digits and -: what a label may hold without care.
    std::string label = name + "-" + scene;
    std::ranges::replace_if(
        label, [](unsigned char c) { return c >= 0x80 || std::isalnum(c) == 0; }, '-');
    return "\\caption{" + latex_text(name) + ", " + latex_text(scene) +
           ": means over seeds with their 95\\,\\% confidence intervals; PSNR of display values "
           "that are not quantised; share: of path tracing's time.}\\label{tab:" +
           label + "}";
}

std::string table(const ReportData& data, const std::string& scene) {
    std::vector<const GroupSummary*> groups;
    for (const GroupSummary& group : data.groups)
        if (group.scene == scene) groups.push_back(&group);
    const std::vector<Column> columns = columns_of(data, groups);
    std::string alignment;
    std::vector<std::string> heads;
    for (const Column& column : columns) {
        alignment += column.alignment;
        heads.push_back(column.head);
    }
    const std::string head = "\\toprule\n" + line(heads) + "\\midrule\n";
    if (groups.size() > kPageRows) {
        return "\n\\begin{longtable}{@{}" + alignment + "@{}}\n" + caption(data, scene) + "\\\\\n" +
               head + "\\endhead\n\\bottomrule\n\\endfoot\n" + body(columns, groups) +
               "\\end{longtable}\n";
    }
    return "\n\\begin{table}\n\\centering\n" + caption(data, scene) + "\n\\begin{tabular}{@{}" +
           alignment + "@{}}\n" + head + body(columns, groups) +
           "\\bottomrule\n\\end{tabular}\n\\end{table}\n";
}

}  // namespace

std::string latex_text(const std::string& text) {
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t length = 1;
        while (i + length < text.size() && (text[i + length] & 0xC0) == 0x80) ++length;
        const std::string_view character = std::string_view(text).substr(i, length);
        const auto known = kCommands.find(character);
        if (known != kCommands.end()) {
            result += known->second;
        } else {
            const bool is_control = static_cast<unsigned char>(character[0]) < ' ';
            const bool is_ligature = character == "-" && result.ends_with('-');
            result += is_ligature ? "{}-" : is_control ? std::string_view(" ") : character;
        }
        i += length;
    }
    return result;
}

std::string summary_latex(const ReportData& data) {
    std::string text =
        "% By vecino report. Needs \\usepackage{booktabs}, and \\usepackage{longtable} for a table "
        "longer than a page.\n";
    for (const std::string& scene : data.scenes) text += table(data, scene);
    return text;
}

}  // namespace vecino
