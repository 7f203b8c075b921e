// SPDX-License-Identifier: Apache-2.0
//
// Where methods fail: methods against failures, each with its number and verdict, and what every
// failure is.
#include <algorithm>
#include <array>

#include "eval/html_text.h"
#include "eval/markdown_text.h"
#include "eval/matrix.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

using Results = std::vector<const FailureResult*>;

struct VerdictMark {
    FailureVerdict verdict;
    const char* mark;
    const char* css;
};
constexpr std::array<VerdictMark, 4> kMarks = {{{FailureVerdict::pass, "✓", "yes"},
                                                {FailureVerdict::degraded, "≈", "trend"},
                                                {FailureVerdict::fails, "✗", "no"},
                                                {FailureVerdict::refuses, "⊘", "none"}}};

constexpr const char* kLegend =
    "✓ passes, ≈ is degraded, ✗ fails, ⊘ cannot be run, as the method refuses what the scene "
    "needs; "
    "– the measure says nothing of the method. ";

const VerdictMark& mark_of(FailureVerdict verdict) {
    return *std::ranges::find(kMarks, verdict, &VerdictMark::verdict);
}

std::string cell_text(const FailureResult& result) {
    const bool is_refusal = result.verdict == FailureVerdict::refuses;
    return std::string(mark_of(result.verdict).mark) + " " +
           (is_refusal ? "cannot" : failure_number(result.value));
}

std::string expected_text(const FailureResult& result) {
    std::string text;
    for (const FailureVerdict verdict : result.expected)
        text += (text.empty() ? "" : " or ") + verdict_name(verdict);
    return text.empty() ? "nothing expected" : text;
}

std::string measure_text(const Measure& measure) {
    const Signature& signature = *measure.signature;
    return std::string(signature.name) + ": " + std::string(signature.summary) +
           (signature.unit.empty() ? "" : " [" + std::string(signature.unit) + "]");
}

std::string limits_text(const FailureCase& failure) {
    const std::string unit(failure.measure.signature->unit);
    return "passes up to " + failure_number(failure.pass_below) + ", fails above " +
           failure_number(failure.fails_above) + (unit.empty() ? "" : " " + unit);
}

struct Tally {
    std::array<std::size_t, kMarks.size()> verdicts{};
    std::size_t unexpected = 0, open = 0;
};

Tally tally(const Failures& failures) {
    Tally tally;
    for (const FailureResult& result : failures.results) {
        ++tally.verdicts[static_cast<std::size_t>(result.verdict)];
        tally.unexpected += result.is_unexpected() ? 1 : 0;
        tally.open += result.expected.empty() ? 1 : 0;
    }
    return tally;
}

std::string tally_text(const Failures& failures) {
    const Tally counts = tally(failures);
    const auto number = [](std::size_t count) { return std::to_string(count); };
    return number(failures.results.size()) + " results on " + number(failures.cases.size()) +
           " scenes: " + number(counts.verdicts[0]) + " pass, " + number(counts.verdicts[1]) +
           " degraded, " + number(counts.verdicts[2]) + " fail, " + number(counts.verdicts[3]) +
           " cannot be run. " + number(counts.unexpected) +
           " of them otherwise than expected; of " + number(counts.open) + " nothing was expected.";
}

// ---- HTML -----------------------------------------------------------------------------------

std::string view_link(const FailureResult& result, const std::string& html) {
    std::string address;
    for (const char c : result.group) address += c == '+' ? "%2B" : std::string(1, c);
    return "<a href=\"#view=" + escaped(address) + "\">" + html + "</a>";
}

std::string title_text(const FailureResult& result, const FailureCase& failure) {
    std::string text = result.group + ": " + failure_number(result.value) + " " +
                       std::string(failure.measure.signature->unit) + ", " +
                       verdict_name(result.verdict) + "; expected: " + expected_text(result);
    return result.reason.empty() ? text : text + "; " + result.reason;
}

/// The worst of a method's results; an unexpected one is told whichever of them it is.
std::string chart_cell(const FailureCase& failure, const Results& results) {
    if (results.empty()) return "<td class=\"none\">–</td>";
    const FailureResult& worst = *results.front();
    const VerdictMark& mark = mark_of(worst.verdict);
    const bool is_unexpected =
        std::ranges::any_of(results, [](const auto* each) { return each->is_unexpected(); });
    std::string html = cell_text(worst);
    if (is_unexpected) html += " <b>!</b>";
    if (results.size() > 1) html += "<small>" + escaped(variant_text(worst.params)) + "</small>";
    return "<td class=\"" + std::string(mark.css) + (is_unexpected ? " odd" : "") + "\" title=\"" +
           escaped(title_text(worst, failure)) + "\">" + view_link(worst, html) + "</td>";
}

/// Names may break where they are joined.
std::string method_head(const std::string& label) {
    const std::size_t comma = label.find(", ");
    std::string name;
    for (const char c : escaped(label.substr(0, comma)))
        name += c == '_' ? "_<wbr>" : std::string(1, c);
    if (comma != std::string::npos)
        name += "<small>" + escaped(label.substr(comma + 2)) + "</small>";
    return "<th scope=\"col\">" + name + "</th>";
}

std::string case_anchor(const FailureCase& failure) {
    return "failure-" + stem(failure.scene);
}

std::string chart_html(const Failures& failures, const std::vector<FailureMethod>& methods) {
    std::string html =
        "<div class=\"fields chart\" tabindex=\"0\" role=\"region\" aria-label=\"Failures by "
        "method\"><table><thead><tr><th scope=\"col\">failure</th>";
    for (const FailureMethod& method : methods) html += method_head(method.label);
    html += "</tr></thead><tbody>\n";
    for (std::size_t i = 0; i < failures.cases.size(); ++i) {
        const FailureCase& failure = failures.cases[i];
        html += "<tr><th scope=\"row\"><a href=\"#" + escaped(case_anchor(failure)) + "\">" +
                escaped(failure.id) + "</a> " + escaped(failure.title) + "<small>" +
                escaped(failure.measure.signature->name) + ", " + escaped(limits_text(failure)) +
                "</small></th>";
        for (const FailureMethod& method : methods) html += chart_cell(failure, method.by_case[i]);
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string result_row(const FailureResult& result, const FailureCase& failure) {
    const VerdictMark& mark = mark_of(result.verdict);
    std::string html = "<tr><td>" + view_link(result, escaped(result.group)) + "</td><td>" +
                       failure_number(result.value) + "</td>";
    for (std::size_t i = 0; i < failure.also.size(); ++i)
        html += "<td>" + (i < result.also.size() ? failure_number(result.also[i]) : "–") + "</td>";
    html += "<td><span class=\"verdict " + std::string(mark.css) + "\">" + mark.mark + " " +
            verdict_name(result.verdict) + "</span>" +
            (result.is_unexpected() ? " <b class=\"odd\">unexpected</b>" : "") + "</td><td>" +
            expected_text(result);
    if (!result.why.empty()) html += "<span class=\"why\">" + escaped(result.why) + "</span>";
    if (!result.reason.empty()) html += "<span class=\"why\">" + escaped(result.reason) + "</span>";
    return html + "</td></tr>\n";
}

std::string case_html(const Failures& failures, std::size_t index) {
    const FailureCase& failure = failures.cases[index];
    const auto fact = [](const std::string& name, const std::string& text) {
        return "<div><dt>" + name + "</dt><dd>" + escaped(text) + "</dd></div>\n";
    };
    std::string html = "<details id=\"" + escaped(case_anchor(failure)) + "\"><summary>" +
                       escaped(failure.id) + " " + escaped(failure.title) + "</summary>\n<p>" +
                       escaped(failure.mechanism) + "</p><dl class=\"facts\">\n" +
                       fact("Measure", measure_text(failure.measure));
    for (const Measure& also : failure.also) html += fact("Also", measure_text(also));
    html += fact("Limits", limits_text(failure) + ": " + failure.limits_from) +
            fact("Reference", failure.reference);
    for (const ExactRadiance& exact : failure.exact)
        html += fact("Exact", "object " + std::to_string(exact.object) + ": " + exact.formula);
    html +=
        "</dl><div class=\"scroll\"><table class=\"plain\"><thead><tr><th scope=\"col\">result</th>"
        "<th scope=\"col\">" +
        escaped(failure.measure.signature->name) + "</th>";
    for (const Measure& also : failure.also)
        html += "<th scope=\"col\">" + escaped(also.signature->name) + "</th>";
    html += "<th scope=\"col\">verdict</th><th scope=\"col\">expected</th></tr></thead><tbody>\n";
    for (const FailureResult& result : failures.results)
        if (result.failure == index) html += result_row(result, failure);
    return html + "</tbody></table></div></details>\n";
}

// ---- Markdown -------------------------------------------------------------------------------

using namespace markdown;

std::string markdown_cell(const Results& results) {
    if (results.empty()) return "–";
    const FailureResult& worst = *results.front();
    std::string text = cell_text(worst);
    if (std::ranges::any_of(results, [](const auto* each) { return each->is_unexpected(); }))
        text += " **!**";
    return text;
}

std::string unexpected_list(const Failures& failures) {
    std::string text;
    for (const FailureResult& result : failures.results) {
        if (!result.is_unexpected()) continue;
        text += "- " + code(result.group) + ": " + failure_number(result.value) + ", " +
                verdict_name(result.verdict) + "; expected: " + expected_text(result) +
                (result.reason.empty() ? "" : "; " + plain(result.reason)) + "\n";
    }
    return text.empty() ? "" : "\nOtherwise than expected:\n\n" + text;
}

std::string cases_markdown(const Failures& failures) {
    std::string text = "\n### What each failure is\n\n" +
                       head({"", "mechanism", "measure", "limits", "reference"});
    for (const FailureCase& failure : failures.cases) {
        text += row({plain(failure.id + " " + failure.title), plain(failure.mechanism),
                     plain(measure_text(failure.measure)),
                     plain(limits_text(failure) + ": " + failure.limits_from),
                     plain(failure.reference)});
    }
    return text;
}

}  // namespace

std::string catalogue_html(const ReportData& data) {
    const Failures& failures = data.failures;
    if (failures.cases.empty()) return "";
    std::string html =
        "<section id=\"catalogue\">\n<h2>Where methods fail</h2>\n<p class=\"note\">Each scene "
        "shows one failure and nothing else; its number tells that very failure, and grows with "
        "it. Limits were set from the reference before any method was measured. " +
        std::string(kLegend) +
        "<b>!</b> is otherwise than expected. A cell holds the worst of the method's factors and "
        "windows. <span class=\"js-only\">A click opens it in the "
        "viewer.</span></p>\n<p class=\"note\">" +
        escaped(tally_text(failures)) + "</p>\n" + chart_html(failures, failure_methods(failures)) +
        "<h3>What each failure is</h3>\n<div class=\"cases\">\n";
    for (std::size_t i = 0; i < failures.cases.size(); ++i) html += case_html(failures, i);
    return html + "</div>\n</section>\n";
}

std::string catalogue_markdown(const ReportData& data) {
    const Failures& failures = data.failures;
    if (failures.cases.empty()) return "";
    const auto methods = failure_methods(failures);
    Cells names{"failure", "measure"};
    for (const FailureMethod& method : methods) names.push_back(plain(method.label));
    std::string text = "\n## Where methods fail\n\n" + tally_text(failures) + " " + kLegend +
                       "**!** is otherwise than expected. Every "
                       "number grows with its failure; a cell holds the worst of the method's "
                       "factors and windows. Limits were set from the reference.\n\n" +
                       head(names);
    for (std::size_t i = 0; i < failures.cases.size(); ++i) {
        const FailureCase& failure = failures.cases[i];
        const Signature& signature = *failure.measure.signature;
        Cells cells{plain(failure.id + " " + failure.title),
                    plain(std::string(signature.name) + ", " + std::string(signature.unit))};
        for (const FailureMethod& method : methods)
            cells.push_back(markdown_cell(method.by_case[i]));
        text += row(cells);
    }
    return text + unexpected_list(failures) + cases_markdown(failures);
}

}  // namespace vecino
