// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <map>
#include <span>

#include "core/files.h"
#include "eval/commands.h"
#include "eval/html_text.h"

namespace vecino {
namespace {

constexpr std::size_t kClosestShown = 5;
constexpr double kDullAbove_db = 1;
constexpr std::size_t kMostMarkdownBytes = 60000;
constexpr std::size_t kMarkdownTailBytes = 2000;  ///< kept for what stands below the tables

constexpr std::array<const char*, 8> kColumns = {"group",    "metric", "rule",   "value",
                                                 "baseline", "limit",  "margin", "class: why"};
using Row = std::array<std::string, kColumns.size()>;

std::string short_number(const std::optional<double>& value) {
    if (!value) return "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.5g", *value);
    return text;
}

std::string margin_text(const Verdict& verdict) {
    if (!verdict.margin_db) return "-";
    return number_text(*verdict.margin_db, 3) + (verdict.rule == "time" ? " %" : " dB");
}

std::string value_text(const Verdict& verdict) {
    std::string text = short_number(verdict.value);
    if (verdict.value_low || verdict.value_high)
        text += " (" + short_number(verdict.value_low) + " to " + short_number(verdict.value_high) +
                ")";
    return text;
}

Row row_of(const Verdict& v) {
    const std::string why = v.class_name.empty() ? v.text : v.class_name + ": " + v.text;
    return {v.group,
            v.metric.empty() ? "-" : v.metric,
            v.rule,
            value_text(v),
            short_number(v.baseline),
            short_number(v.limit),
            margin_text(v),
            one_line(why)};
}

using Verdicts = std::vector<const Verdict*>;

Verdicts verdicts_of(const GateResult& result, GateOutcome outcome) {
    Verdicts found;
    for (const Verdict& verdict : result.verdicts)
        if (verdict.outcome == outcome) found.push_back(&verdict);
    return found;
}

/// Columns as wide as they need to be; the last one is not padded.
std::string text_table(std::span<const Verdict* const> verdicts) {
    std::vector<Row> rows(1);
    std::ranges::copy(kColumns, rows.front().begin());
    for (const Verdict* verdict : verdicts) rows.push_back(row_of(*verdict));
    std::array<std::size_t, kColumns.size()> widths{};
    for (const Row& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    std::string text;
    for (const Row& row : rows) {
        for (std::size_t i = 0; i + 1 < row.size(); ++i)
            text += row[i] + std::string(widths[i] - row[i].size() + 2, ' ');
        text += row.back() + "\n";
    }
    return text;
}

/// Reasons of one kind in one line: what differs between groups is left to --json.
std::string not_gated_text(const GateResult& result) {
    std::map<std::string, std::size_t> reasons;
    for (const Verdict* verdict : verdicts_of(result, GateOutcome::not_gated)) {
        const std::string& text = verdict->text;
        const std::size_t reason = verdict->rule == "time" ? text.find("not gated") : 0;
        ++reasons[verdict->rule + ": " + text.substr(std::min(reason, text.size()))];
    }
    std::string lines;
    for (const auto& [reason, count] : reasons)
        lines += "not gated: " + std::to_string(count) + " x " + one_line(reason) + "\n";
    return lines;
}

std::string time_line(const GateResult& result) {
    std::vector<double> ratios;
    for (const Verdict& verdict : result.verdicts) {
        if (verdict.rule == "time" && verdict.value && verdict.baseline)
            ratios.push_back(*verdict.value / *verdict.baseline);
    }
    if (ratios.empty()) return "";
    std::ranges::sort(ratios);
    return "time, over the baseline's: " + number_text(ratios.front(), 2) + " to " +
           number_text(ratios.back(), 2) + " x, median " +
           number_text(ratios[ratios.size() / 2], 2) + " x\n";
}

/// A gate that lets a decibel through as noise is not of much use, and few seeds make it so.
std::string dull_line(const GateResult& result) {
    const auto is_dull = [](const Verdict& v) { return v.noise_db && *v.noise_db > kDullAbove_db; };
    const auto count = std::ranges::count_if(result.verdicts, is_dull);
    if (count == 0) return "";
    return "warning: in " + std::to_string(count) + " comparisons noise explains more than " +
           number_text(kDullAbove_db, 0) + " dB: more seeds see smaller losses\n";
}

std::string unused_line(const GateResult& result) {
    std::string text;
    for (const std::string& name : result.unused)
        text += "warning: no cell is of the class \"" + one_line(name) + "\"\n";
    return text;
}

std::string identical_line(const GateResult& result) {
    return std::to_string(result.identical) + " of " + std::to_string(result.groups) +
           " groups have the baseline's very numbers\n";
}

std::string markdown_text(const std::string& text) {
    std::string result;
    for (const char c : escaped(one_line(text))) {
        if (std::string_view("|`*_[]\\~").find(c) != std::string_view::npos) result += '\\';
        result += c;
    }
    return result;
}

std::string markdown_row(const Row& row) {
    std::string line = "|";
    for (const std::string& cell : row) line += " " + markdown_text(cell) + " |";
    return line + "\n";
}

/// As many rows as fit below a size; says how many did not.
std::string markdown_table(const Verdicts& verdicts, std::size_t most_bytes) {
    Row header;
    std::ranges::copy(kColumns, header.begin());
    std::string text = markdown_row(header) + "|---|---|---|---|---|---|---|---|\n";
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        const std::string row = markdown_row(row_of(*verdicts[i]));
        if (text.size() + row.size() > most_bytes)
            return text + "\nand " + std::to_string(verdicts.size() - i) + " more\n";
        text += row;
    }
    return text;
}

std::string details(const std::string& summary, const std::string& body) {
    return "\n<details><summary>" + summary + "</summary>\n\n" + body + "\n</details>\n";
}

}  // namespace

std::string gate_headline(const GateResult& result) {
    const std::size_t failed = result.count(GateOutcome::fail);
    const std::size_t judged = failed + result.count(GateOutcome::pass);
    const std::string what = "of " + std::to_string(judged) + " comparisons in " +
                             std::to_string(result.groups) + " groups of " + result.matrix;
    if (judged == 0)
        return "FAIL: nothing to judge in " + std::to_string(result.groups) + " groups of " +
               result.matrix;
    if (failed == 0) return "PASS: none " + what + " failed";
    return "FAIL: " + std::to_string(failed) + " " + what + " failed, worst first";
}

std::string gate_text(const GateResult& result) {
    std::string text = one_line(gate_headline(result)) + "\n";
    if (!result.passed()) text += text_table(verdicts_of(result, GateOutcome::fail));
    const Verdicts passed = verdicts_of(result, GateOutcome::pass);
    const std::span closest(passed.data(), std::min(kClosestShown, passed.size()));
    if (!closest.empty())
        text += "\n" + std::to_string(passed.size()) + " passed, closest to their limits:\n" +
                text_table(closest);
    return text + "\n" + identical_line(result) + time_line(result) + not_gated_text(result) +
           dull_line(result) + unused_line(result);
}

std::string gate_markdown(const GateResult& result) {
    std::string text = "### vecino check: " + markdown_text(gate_headline(result)) + "\n\n";
    // Failures may take all of the room; passes take what is left.
    const auto room = [&] {
        const std::size_t taken = text.size() + kMarkdownTailBytes;
        return taken < kMostMarkdownBytes ? kMostMarkdownBytes - taken : 0;
    };
    if (!result.passed()) text += markdown_table(verdicts_of(result, GateOutcome::fail), room());
    const Verdicts passed = verdicts_of(result, GateOutcome::pass);
    if (!passed.empty())
        text += details(std::to_string(passed.size()) + " passed, closest to their limits first",
                        markdown_table(passed, room()));
    std::string rest = identical_line(result) + "\n" + time_line(result) + "\n" +
                       not_gated_text(result) + dull_line(result) + unused_line(result);
    if (rest.size() > kMarkdownTailBytes / 2) rest.resize(kMarkdownTailBytes / 2);
    std::string escaped_rest;
    for (std::size_t start = 0; start < rest.size();) {
        const std::size_t end = std::min(rest.find('\n', start), rest.size());
        escaped_rest += markdown_text(rest.substr(start, end - start)) + "\n";
        start = end + 1;
    }
    return text + "\n" + escaped_rest;
}

}  // namespace vecino
