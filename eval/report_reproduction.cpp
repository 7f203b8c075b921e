// SPDX-License-Identifier: Apache-2.0
//
// What the report says about the publication that a matrix reproduces: its numbers and its claims
// with a verdict each, and its graphs.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "eval/commands.h"
#include "eval/html_text.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

struct VerdictStyle {
    ClaimVerdict verdict;
    const char* mark;
    const char* css;
};
constexpr std::array<VerdictStyle, 4> kVerdicts = {{{ClaimVerdict::reproduced, "✓", "yes"},
                                                    {ClaimVerdict::trend, "≈", "trend"},
                                                    {ClaimVerdict::not_reproduced, "✗", "no"},
                                                    {ClaimVerdict::not_testable, "–", "untested"}}};

std::string badge(ClaimVerdict verdict) {
    const auto* const style = std::ranges::find(kVerdicts, verdict, &VerdictStyle::verdict);
    return "<span class=\"verdict " + std::string(style->css) + "\">" + style->mark + " " +
           verdict_text(verdict) + "</span>";
}

std::string signed_db(double value) {
    const std::string digits = number_text(std::abs(value), 2);
    if (digits == "0.00") return digits;
    return (value < 0 ? "−" : "+") + digits;
}

/// "+3.20 ± 0.15"
std::string difference_text(const PairResult& pair) {
    if (pair.outcome == PairOutcome::missing) return "no value";
    const Estimate& d = pair.difference_db;
    std::string text = signed_db(d.mean) + " ± " + number_text(0.5 * (*d.high - *d.low), 2);
    if (pair.published_db) text += " (" + signed_db(*pair.published_db) + ")";
    return text;
}

/// "22 of 24 hold; +0.31 to +4.20 dB"
std::string counts_text(const ClaimResult& result) {
    const std::size_t all = result.holds + result.fails + result.open + result.missing;
    std::string text = std::to_string(result.holds) + " of " + std::to_string(all) + " hold";
    if (result.open > 0) text += ", " + std::to_string(result.open) + " open";
    if (result.missing > 0) text += ", " + std::to_string(result.missing) + " missing";
    std::vector<double> differences;
    for (const PairResult& pair : result.pairs) {
        if (pair.outcome != PairOutcome::missing) differences.push_back(pair.difference_db.mean);
    }
    if (differences.empty()) return text;
    const auto [least, most] = std::ranges::minmax(differences);
    text += "<br>" + signed_db(least);
    if (differences.size() > 1) text += " to " + signed_db(most);
    return text + " dB";
}

const char* outcome_mark(PairOutcome outcome) {
    switch (outcome) {
        case PairOutcome::holds:
            return "✓";
        case PairOutcome::fails:
            return "✗";
        case PairOutcome::open:
            return "?";
        case PairOutcome::missing:
            break;
    }
    return "–";
}

/// Names of the methods that a selection may pick; all where it names none.
void add_methods(const Selection& selection, std::set<std::string>& methods, bool& is_any) {
    is_any = is_any || !selection.names("method");
    for (const Json& method : selection.at("method")) methods.insert(method.get<std::string>());
}

std::string only_methods(const ReportData& data, const std::set<std::string>& methods,
                         bool is_any) {
    std::string command = run_command_text(data);
    if (is_any) return command;
    std::string names;
    for (const std::string& method : methods) names += (names.empty() ? "" : "|") + method;
    return command + " --only " + shell_word("\\.(" + names + ")\\.");
}

std::string claim_command(const ReportData& data, const Claim& claim) {
    std::set<std::string> methods;
    bool is_any = false;
    for (const ClaimTest& test : claim.tests) {
        add_methods(test.of, methods, is_any);
        add_methods(test.than, methods, is_any);
    }
    return only_methods(data, methods, is_any);
}

std::string item_command(const ReportData& data, const Item& item) {
    std::set<std::string> methods{"path"};
    bool is_any = false;
    add_methods(item.of, methods, is_any);
    return only_methods(data, methods, is_any);
}

std::string command_html(const std::string& command) {
    return "<p class=\"remake\">Made again by <code>" + escaped(command) + "</code></p>";
}

std::string group_link(const ReportData& data, const std::string& group) {
    const auto found = std::ranges::find(data.groups, group, &GroupSummary::group);
    if (found == data.groups.end()) return escaped(group);
    const auto index = std::to_string(found - data.groups.begin());
    return "<a href=\"#g" + index + "\">" + escaped(group) + "</a>";
}

std::string data_cell(const std::string& label, const std::string& html) {
    return "<td data-label=\"" + escaped(label) + "\">" + html + "</td>";
}

std::string value_text(const Estimate& value, const Item& item) {
    const int decimals = item.unit == "%" ? 2 : 3;
    std::string text = number_text(value.mean, decimals);
    if (value.low) text += " ± " + number_text(0.5 * (*value.high - *value.low), decimals);
    return text + " " + item.unit;
}

/// One row: what was published, what came out here.
std::string item_row(const ReportData& data, const Item& item, const ItemResult& result) {
    std::string ours = result.ours ? value_text(*result.ours, item) : "–";
    if (result.tested) {
        const Variant& variant = data.reproduction->specification.variants.front();
        ours += "<span class=\"why\">" + value_text(*result.tested, item) + " at " +
                escaped(variant.tested_at.text()) + "</span>";
    }
    std::string about = escaped(item.text);
    if (!item.note.empty()) about += "<span class=\"why\">" + escaped(item.note) + "</span>";
    about += "<details><summary>how</summary>";
    if (!result.slowest.empty())
        about += "<p>The slowest: " + group_link(data, result.slowest) + ".</p>";
    about += command_html(item_command(data, item)) + "</details>";
    std::string verdict = badge(result.verdict);
    if (result.verdict != ClaimVerdict::not_testable && item.within > 0)
        verdict += "<span class=\"why\">within " + number_text(item.within, 0) + " points</span>";
    if (!result.remark.empty())
        verdict += "<span class=\"why\">" + escaped(result.remark) + "</span>";
    return "<tr id=\"item-" + escaped(item.id) + "\"><th scope=\"row\">" + escaped(item.section) +
           "</th><td class=\"what\">" + about + "</td>" +
           data_cell("published", number_text(item.published, 2) + " " + item.unit) +
           data_cell("here", ours) +
           data_cell("ratio", result.ours ? number_text(result.ratio, 3) : "–") +
           data_cell("verdict", verdict) + "</tr>\n";
}

const ClaimResult* find_result(const std::vector<ClaimResult>& results, const std::string& variant,
                               const RegionName& region) {
    const auto found = std::ranges::find_if(results, [&](const ClaimResult& result) {
        return result.variant == variant && result.region == region;
    });
    return found == results.end() ? nullptr : &*found;
}

std::string pairs_html(const ReportData& data, const ClaimResult& whole,
                       const ClaimResult* interior) {
    std::string html =
        "<table class=\"pairs\"><thead><tr><th scope=\"col\">of</th><th "
        "scope=\"col\">than</th><th scope=\"col\">difference, dB</th>";
    html += interior == nullptr ? "" : "<th scope=\"col\">interior</th>";
    html += "</tr></thead><tbody>\n";
    for (std::size_t i = 0; i < whole.pairs.size(); ++i) {
        const PairResult& pair = whole.pairs[i];
        html += "<tr><td>" + group_link(data, pair.of) + "</td><td>" + group_link(data, pair.than) +
                "</td><td>" + difference_text(pair) + " " + outcome_mark(pair.outcome) + "</td>";
        if (interior != nullptr) {
            const PairResult& inner = interior->pairs[i];
            html += "<td>" + difference_text(inner) + " " + outcome_mark(inner.outcome) + "</td>";
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table>\n";
}

std::string claim_details(const ReportData& data, std::size_t index) {
    const ReportReproduction& shown = *data.reproduction;
    std::string html = "<details><summary>every comparison</summary>";
    for (const Variant& variant : shown.specification.variants) {
        const auto& results = shown.result.claims[index];
        const ClaimResult* const whole = find_result(results, variant.id, "");
        const std::string tested = variant.tested_at.text();
        html += "<h4>" + escaped(variant.label) +
                (tested.empty() ? "" : ", at " + escaped(tested) + " (as published)") + "</h4>" +
                pairs_html(data, *whole, find_result(results, variant.id, "interior"));
    }
    return html + command_html(claim_command(data, shown.specification.claims[index])) +
           "</details>";
}

std::string claim_cell(const std::vector<ClaimResult>& results, const Variant& variant) {
    const ClaimResult& whole = *find_result(results, variant.id, "");
    std::string html = badge(whole.verdict) + "<span class=\"why\">" + counts_text(whole);
    if (!variant.tested_at.empty()) html += "<br>at " + escaped(variant.tested_at.text());
    html += "</span>";
    const ClaimResult* const interior = find_result(results, variant.id, "interior");
    if (interior != nullptr)
        html += "<span class=\"inner\">interior: " + badge(interior->verdict) + "</span>";
    return data_cell(variant.label, html);
}

std::string claim_row(const ReportData& data, std::size_t index) {
    const ReportReproduction& shown = *data.reproduction;
    const Claim& claim = shown.specification.claims[index];
    std::string html = "<tr id=\"claim-" + escaped(claim.id) + "\"><th scope=\"row\">" +
                       escaped(claim.section) + "</th><td class=\"what\">" + escaped(claim.text);
    if (!claim.note.empty()) html += "<span class=\"why\">" + escaped(claim.note) + "</span>";
    html += claim_details(data, index) + "</td>";
    for (const Variant& variant : shown.specification.variants)
        html += claim_cell(shown.result.claims[index], variant);
    return html + "</tr>\n";
}

std::string tally(const ReportReproduction& shown) {
    std::string html = "<table class=\"repro tally\"><thead><tr><th scope=\"col\"></th>";
    for (const VerdictStyle& style : kVerdicts)
        html += "<th scope=\"col\">" + badge(style.verdict) + "</th>";
    html += "</tr></thead><tbody>\n";
    const auto row = [&](const std::string& name, const auto& count) {
        html += "<tr><th scope=\"row\">" + escaped(name) + "</th>";
        for (const VerdictStyle& style : kVerdicts)
            html += data_cell(verdict_text(style.verdict), std::to_string(count(style.verdict)));
        html += "</tr>\n";
    };
    row("numbers", [&](ClaimVerdict verdict) {
        return std::ranges::count(shown.result.items, verdict, &ItemResult::verdict);
    });
    for (const Variant& variant : shown.specification.variants) {
        row("claims, " + variant.label, [&](ClaimVerdict verdict) {
            return std::ranges::count_if(shown.result.claims, [&](const auto& results) {
                return find_result(results, variant.id, "")->verdict == verdict;
            });
        });
    }
    return html + "</tbody></table>\n";
}

std::string head_row(const std::vector<std::string>& names) {
    std::string html = "<thead><tr>";
    for (const std::string& name : names) html += "<th scope=\"col\">" + escaped(name) + "</th>";
    return html + "</tr></thead><tbody>\n";
}

/// Says so where a run is not at the published parameters.
std::string parameters_note(const ReportData& data) {
    const Reproduction& specification = data.reproduction->specification;
    const auto paths = std::ranges::find_if(data.groups, [&](const GroupSummary& group) {
        return group.method == "path" &&
               Selection().matches(group.params, specification.variants.front().where);
    });
    if (paths == data.groups.end()) return "";
    std::string here;
    std::string published;
    for (const std::string& key : specification.times_at.mismatches(paths->params)) {
        const Json wanted{{key, specification.times_at.at(key).front()}};
        here += (here.empty() ? "" : ", ") + key + " " + parameter_text(paths->params, key);
        published += (published.empty() ? "" : ", ") + key + " " + parameter_text(wanted, key);
    }
    if (here.empty()) return "";
    return "<p class=\"note\"><em>Not the published parameters:</em> here " + escaped(here) +
           "; published " + escaped(published) + ". The verdicts are those of this run.</p>\n";
}

}  // namespace

std::string reproduction_html(const ReportData& data) {
    if (!data.reproduction) return "";
    const ReportReproduction& shown = *data.reproduction;
    const Reproduction& specification = shown.specification;
    std::string html = "<section id=\"reproduction\">\n<h2>What holds of " +
                       escaped(specification.source) + "</h2>\n" + parameters_note(data) +
                       tally(shown);
    html +=
        "<p class=\"note\">A claim is <em>reproduced</em> if every comparison holds, its 95 % "
        "interval over seeds excluding equality; a <em>trend</em> if most do. <em>Quality</em> is "
        "psnr_float_db, <em>noise</em> the variance over seeds, <em>definition</em> the error at "
        "edges; differences are in dB, first less second. <em>Interior</em> is the same away from "
        "emitters and edges. A share of time is reproduced if its interval lies within the stated "
        "points. Where the published samples were traced with one seed, which has no interval, "
        "seeds of fewer samples decide, as stated beside the verdict; where the published samples "
        "say the opposite, a comparison is open.</p>\n<h3>Numbers</h3>\n<table class=\"repro\">" +
        head_row({"§", "what", "published", "here", "ratio", "verdict"});
    for (std::size_t i = 0; i < specification.items.size(); ++i)
        html += item_row(data, specification.items[i], shown.result.items[i]);
    std::vector<std::string> names{"§", "claim"};
    for (const Variant& variant : specification.variants) names.push_back(variant.label);
    html += "</tbody></table>\n<h3>Claims</h3>\n<table class=\"repro claims\">" + head_row(names);
    for (std::size_t i = 0; i < specification.claims.size(); ++i) html += claim_row(data, i);
    return html + "</tbody></table>\n</section>\n";
}

std::string graphs_html(const ReportData& data) {
    if (!data.reproduction || data.reproduction->specification.graphs.empty()) return "";
    std::string html =
        "<section id=\"graphs\">\n<h2>Graphs</h2>\n<p class=\"note\">Time per image in seconds, "
        "median over "
        "seeds, on this machine, beside path tracing's.</p>\n<noscript><p class=\"note\">The "
        "graphs need JavaScript; the times stand in the results table.</p></noscript>\n<div "
        "class=\"graphs js-only\">\n";
    for (const Graph& graph : data.reproduction->specification.graphs) {
        html += "<figure><figcaption>" + escaped(graph.title) +
                "</figcaption><div class=\"plot low\"><canvas role=\"img\" data-graph=\"" +
                escaped(graph.id) + "\" aria-label=\"" + escaped(graph.title) +
                "\"></canvas></div></figure>\n";
    }
    return html + "</div>\n</section>\n";
}

/// Bars by what tells results apart, path tracing first; one colour per scene.
Json graphs_json(const ReportData& data) {
    Json graphs = Json::array();
    if (!data.reproduction) return graphs;
    const Reproduction& specification = data.reproduction->specification;
    const Variant& variant = specification.variants.front();
    for (const Graph& graph : specification.graphs) {
        Json bars = Json::array();
        const auto add = [&](const GroupSummary& group, const std::string& label) {
            bars.push_back({{"scene", group.scene},
                            {"label", label},
                            {"time_s", group.time_s},
                            {"id", "g" + std::to_string(index_of(data, group))}});
        };
        for (const GroupSummary& group : data.groups) {
            if (group.method == "path" && Selection().matches(group.params, variant.where))
                add(group, "path");
        }
        for (const GroupSummary* group : select(data.groups, graph.of, variant)) {
            if (group->method != "path")
                add(*group, short_name(*group).substr(group->method.size() + 1));
        }
        graphs.push_back({{"id", graph.id}, {"bars", bars}});
    }
    return graphs;
}

}  // namespace vecino
