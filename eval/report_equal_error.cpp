// SPDX-License-Identifier: Apache-2.0
//
// What time budgets buy: results, what was expected of them, and the time that other methods take
// to the same error.
#include <string>

#include "eval/commands.h"
#include "eval/equal_error.h"
#include "eval/html_text.h"
#include "eval/markdown_text.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

constexpr const char* kNote =
    "For each time budget what was spent and reached, and how many times as long others take to "
    "the same psnr_float_db; the reference's own error is taken off all of them. Times are of "
    "tracing and reconstruction, medians over seeds. e: extrapolated beyond the last point that "
    "was "
    "run, along the slope of errors against spp; ≤: the fewest samples that were run are better "
    "already, so that the factor is at most this.";

/// All but the factors, whose columns are the rivals.
constexpr const char* kNames[] = {"scene", "budget, s", "spent, s", "psnr_float_db", "expected"};

std::vector<std::string> texts_of(const EqualErrorRow& row) {
    const GroupSummary& group = *row.group;
    std::vector<std::string> texts{group.scene, group.params["time_budget"].dump(),
                                   number_text(group.work_s(), 3),
                                   number_text(error_in_db(row.error), 2),
                                   group.predicted_db ? number_text(*group.predicted_db, 1) : "–"};
    for (const auto& factor : row.factors) texts.push_back(equal_error_text(factor));
    return texts;
}

std::vector<std::string> names_of(const EqualErrorTable& table) {
    std::vector<std::string> names(std::begin(kNames), std::end(kNames));
    names.insert(names.end(), table.rivals.begin(), table.rivals.end());
    return names;
}

}  // namespace

std::string equal_error_html(const ReportData& data) {
    const EqualErrorTable table = equal_error(data.groups);
    if (table.rows.empty()) return "";
    std::string html =
        "<section id=\"equal-error\">\n<h2>Time to equal error</h2>\n<p class=\"note\">";
    html += std::string(kNote) +
            "</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Time to equal "
            "error\"><table>\n<thead><tr>";
    for (const std::string& name : names_of(table))
        html += "<th scope=\"col\"><span class=\"name\">" + escaped(name) + "</span></th>";
    html += "</tr></thead><tbody>\n";
    std::string scene;
    for (const EqualErrorRow& row : table.rows) {
        html += row.group->scene != scene ? "<tr class=\"first-of-scene\">" : "<tr>";
        scene = row.group->scene;
        const auto texts = texts_of(row);
        for (std::size_t i = 0; i < texts.size(); ++i) {
            const bool is_head = i == 1;
            html +=
                (is_head ? "<th scope=\"row\" data-scene=\"" + escaped(scene) + "\">" : "<td>") +
                escaped(texts[i]) + (is_head ? "</th>" : "</td>");
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n</section>\n\n";
}

std::string equal_error_markdown(const ReportData& data) {
    const EqualErrorTable table = equal_error(data.groups);
    if (table.rows.empty()) return "";
    markdown::Cells names;
    for (const std::string& name : names_of(table)) names.push_back(markdown::plain(name));
    std::string text =
        "\n## Time to equal error\n\n" + std::string(kNote) + "\n\n" + markdown::head(names);
    for (const EqualErrorRow& row : table.rows) {
        markdown::Cells cells;
        for (const std::string& each : texts_of(row)) cells.push_back(markdown::plain(each));
        text += markdown::row(cells);
    }
    return text;
}

}  // namespace vecino
