// SPDX-License-Identifier: Apache-2.0
//
// A run as Markdown tables, for a repository to keep: what was published, what came out here and
// the verdict, every result, and how good the references are. No pictures.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "eval/commands.h"
#include "eval/markdown_text.h"
#include "eval/reference_error.h"
#include "eval/reference_quality.h"
#include "eval/report_facts.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

using Json = nlohmann::json;
using namespace markdown;

std::string significant(double value, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

std::string signed_db(double value) {
    const std::string digits = number_text(std::abs(value), 2);
    if (digits == "0.00") return digits;
    return (value < 0 ? "−" : "+") + digits;
}

std::string half_width(const Estimate& e, int digits) {
    if (!e.low || !e.high) return "";
    return " ± " + number_text(0.5 * (*e.high - *e.low), digits);
}

std::string joined(const Cells& parts, const std::string& between) {
    std::string text;
    for (const std::string& part : parts) {
        if (!part.empty()) text += (text.empty() ? "" : between) + part;
    }
    return text;
}

std::string facts(const ReportData& data) {
    std::string text = head({"", ""});
    for (const Fact& fact : run_facts(data)) text += row({plain(fact.name), plain(fact.value)});
    return text + row({"Made again by", code(run_command_text(data))});
}

/// "spp 1000, seeds 1, 2, 3, 4": of the first results of a variant that a claim compares.
std::string seeds_text(const ReportData& data, const Variant& variant) {
    const auto found = std::ranges::find_if(data.groups, [&](const GroupSummary& group) {
        return group.method == "path" && Selection().matches(group.params, variant.where);
    });
    if (found == data.groups.end()) return "no results";
    std::string text = "spp " + parameter_text(found->params, "spp");
    text += found->seeds == 1 ? ", seed" : ", seeds";
    for (std::size_t i = 0; i < found->seeds_done.size(); ++i)
        text += (i == 0 ? " " : ", ") + std::to_string(found->seeds_done[i]);
    return text;
}

std::string item_value(const std::optional<Estimate>& value, const Item& item) {
    if (!value) return "–";
    const int decimals = item.unit == "%" ? 2 : 3;
    return number_text(value->mean, decimals) + half_width(*value, decimals) + " " + item.unit;
}

std::string numbers(const ReportData& data) {
    const ReportReproduction& shown = *data.reproduction;
    const Variant& variant = shown.specification.variants.front();
    const bool is_apart = !variant.tested_at.empty();
    Cells names{"§", "what", "published", "ours (" + seeds_text(data, variant) + ")"};
    if (is_apart) names.push_back("ours (" + seeds_text(data, variant.tested()) + ")");
    names.insert(names.end(), {"verdict", "why"});
    std::string text = "\n## Numbers\n\n" + head(names);
    for (std::size_t i = 0; i < shown.specification.items.size(); ++i) {
        const Item& item = shown.specification.items[i];
        const ItemResult& result = shown.result.items[i];
        Cells cells{plain(item.section), plain(item.text),
                    number_text(item.published, 2) + " " + item.unit,
                    item_value(result.ours, item)};
        if (is_apart) cells.push_back(item_value(result.tested, item));
        const std::string within =
            item.within > 0 ? "Within " + number_text(item.within, 0) + " points." : "";
        cells.push_back(verdict_text(result.verdict));
        cells.push_back(plain(joined({within, item.note, result.remark}, " ")));
        text += row(cells);
    }
    return text;
}

/// Of the pairs that have values, the least and the most: "−0.31 ± 0.02 to +4.20 ± 0.15".
std::string range_text(const ClaimResult& result) {
    std::vector<const PairResult*> pairs;
    for (const PairResult& pair : result.pairs) {
        if (pair.outcome != PairOutcome::missing) pairs.push_back(&pair);
    }
    if (pairs.empty()) return "–";
    const auto value = [](const PairResult* pair) { return pair->difference_db.mean; };
    const auto text = [](const PairResult& pair) {
        return signed_db(pair.difference_db.mean) + half_width(pair.difference_db, 2);
    };
    const auto [least, most] = std::ranges::minmax_element(pairs, {}, value);
    return text(**least) + (pairs.size() == 1 ? "" : " to " + text(**most));
}

std::string published_text(const ClaimResult& result) {
    std::vector<double> values;
    for (const PairResult& pair : result.pairs) {
        if (pair.published_db) values.push_back(*pair.published_db);
    }
    if (values.empty()) return "–";
    const auto [least, most] = std::ranges::minmax(values);
    return signed_db(least) + (values.size() == 1 ? "" : " to " + signed_db(most));
}

std::string counts_text(const ClaimResult& result) {
    const std::size_t all = result.holds + result.fails + result.open + result.missing;
    std::string text = std::to_string(result.holds) + " of " + std::to_string(all);
    if (result.open > 0) text += ", " + std::to_string(result.open) + " open";
    if (result.missing > 0) text += ", " + std::to_string(result.missing) + " missing";
    return text;
}

std::string claims(const ReportData& data, const Variant& variant) {
    const ReportReproduction& shown = *data.reproduction;
    const bool is_apart = !variant.tested_at.empty();
    Cells names{"§", "claim", "holds in", "ours, dB (" + seeds_text(data, variant.tested()) + ")"};
    if (is_apart) names.push_back("ours, dB (" + seeds_text(data, variant) + ")");
    names.insert(names.end(), {"verdict", "interior", "why"});
    std::string text = "\n## Claims: " + plain(variant.label) + "\n\n" + head(names);
    for (std::size_t i = 0; i < shown.specification.claims.size(); ++i) {
        const Claim& claim = shown.specification.claims[i];
        const auto& results = shown.result.claims[i];
        const auto of_region = [&](const RegionName& region) {
            return std::ranges::find_if(results, [&](const ClaimResult& result) {
                return result.variant == variant.id && result.region == region;
            });
        };
        const ClaimResult& whole = *of_region("");
        const auto interior = of_region("interior");
        Cells cells{plain(claim.section), plain(claim.text), counts_text(whole), range_text(whole)};
        if (is_apart) cells.push_back(published_text(whole));
        cells.push_back(verdict_text(whole.verdict));
        cells.push_back(interior == results.end() ? "" : verdict_text(interior->verdict));
        cells.push_back(plain(claim.note));
        text += row(cells);
    }
    return text;
}

std::string tally(const ReportReproduction& shown) {
    constexpr ClaimVerdict kAll[] = {ClaimVerdict::reproduced, ClaimVerdict::trend,
                                     ClaimVerdict::not_reproduced, ClaimVerdict::not_testable};
    Cells names{""};
    for (const ClaimVerdict verdict : kAll) names.push_back(verdict_text(verdict));
    std::string text = "\n" + head(names);
    const auto add = [&](const std::string& name, const auto& count) {
        Cells cells{plain(name)};
        for (const ClaimVerdict verdict : kAll) cells.push_back(std::to_string(count(verdict)));
        text += row(cells);
    };
    add("numbers", [&](ClaimVerdict verdict) {
        return std::ranges::count(shown.result.items, verdict, &ItemResult::verdict);
    });
    for (const Variant& variant : shown.specification.variants) {
        add("claims, " + variant.label, [&](ClaimVerdict verdict) {
            return std::ranges::count_if(shown.result.claims, [&](const auto& results) {
                return std::ranges::any_of(results, [&](const ClaimResult& result) {
                    return result.variant == variant.id && result.region.empty() &&
                           result.verdict == verdict;
                });
            });
        });
    }
    return text;
}

std::string reproduction(const ReportData& data) {
    if (!data.reproduction) return "";
    const ReportReproduction& shown = *data.reproduction;
    std::string text =
        "\n## What holds of " + plain(shown.specification.source) + "\n" + tally(shown) +
        "\nA claim is *reproduced* if every comparison holds, its 95 % interval over seeds "
        "excluding equality; a *trend* if most do. Differences are in dB, first less second, the "
        "least and the most of all comparisons: of *quality* (psnr_float_db), or of *noise* "
        "(variance over seeds). *Interior* is the same away from emitters and edges. Where the "
        "published samples were traced with one seed alone, which has no interval, the seeds of "
        "fewer samples decide; a comparison in which the published samples say the opposite is "
        "open. One seed shows no noise.\n" +
        numbers(data);
    for (const Variant& variant : shown.specification.variants) text += claims(data, variant);
    return text;
}

std::string quality_text(const std::optional<Estimate>& value) {
    return value ? number_text(value->mean, 2) + half_width(*value, 2) : "–";
}

std::string results(const ReportData& data) {
    std::string text =
        "\n## Results\n\nMeans over seeds with their 95 % intervals. The share is that of the time "
        "of path tracing at the spp that was asked for.\n";
    if (std::ranges::any_of(data.groups, [](const auto& g) { return g.is_limited == true; }))
        text += "\n≈R: " + plain(std::string(kLimitedFormula)) + ".\n";
    for (const std::string& scene : data.scenes) {
        text += "\n### " + plain(scene) + "\n\n" +
                head({"result", "seeds", "spp", "psnr_float_db, dB", "interior, dB", "ssim",
                      "time, s", "share"});
        for (const GroupSummary& group : data.groups) {
            if (group.scene != scene) continue;
            const bool is_traced = group.params.contains("spp");
            std::string psnr = is_identical(data, group, "psnr_float_db")
                                   ? "identical"
                                   : quality_text(group.psnr_float_db);
            if (group.is_limited == true) psnr += " ≈R";
            text += row({code(short_name(group)), std::to_string(group.seeds),
                         is_traced ? parameter_text(group.params, "spp") : "", psnr,
                         quality_text(group.region_psnr_float_db[region_index(Region::interior)]),
                         group.ssim ? number_text(group.ssim->mean, 4) : "–",
                         is_traced ? significant(group.time_s, 4) : "",
                         is_traced && group.time_share > 0
                             ? number_text(100 * group.time_share, 2) + " %"
                             : ""});
        }
    }
    return text;
}

std::string stability(const ReportData& data) {
    if (!has_stability(data)) return "";
    std::string text = "\n## Stability\n\n" + stability_introduction() + "\n\n";
    for (const StabilityInfo& info : stability_columns())
        text += "- *" + std::string(info.name) + "*: " + plain(std::string(info.formula)) + "\n";
    for (const std::string& scene : data.scenes) {
        const StabilityTable table = stability_table(data, scene);
        if (table.rows.empty()) continue;
        Cells names;
        for (const std::string& name : table.names) names.push_back(plain(name));
        text += "\n### Stability on " + plain(scene) + "\n\n" + head(names);
        for (std::size_t i = 0; i < table.rows.size(); ++i) {
            Cells cells{code(table.results[i])};
            cells.insert(cells.end(), table.rows[i].begin(), table.rows[i].end());
            text += row(cells);
        }
    }
    return text;
}

std::string references(const ReportData& data) {
    std::string text =
        "\n## References\n\nA reference's own error, from the difference of its two halves, and "
        "the best result that it judges; a margin of 15 dB puts at most 3 % into that result's "
        "error.\n\n" +
        head({"scene", "region", "own error, dB", "best result, dB", "", "margin, dB",
              "results within 15 dB"});
    for (const ReferenceQuality& reference : reference_quality(data)) {
        for (const ReferencePart& part : reference.parts) {
            const auto margin = part.margin_db();
            text += row({plain(reference.scene), part.region.empty() ? "whole" : part.region,
                         part.own_db ? number_text(*part.own_db, 2) : "–",
                         part.best_db ? number_text(*part.best_db, 2) : "–", code(part.best),
                         margin ? number_text(*margin, 2) : "–",
                         part.own_db ? std::to_string(part.too_close.size()) : "–"});
        }
    }
    return text;
}

std::string failures(const ReportData& data) {
    if (failed_rows(data) == 0) return "";
    std::string text = "\n## Failures\n\n" + head({"cell", "reason"});
    for (const Json& each : data.rows) {
        if (each["status"] == "ok") continue;
        text += row({code(text_of(each["cell"])), plain(each.value("reason", "unknown"))});
    }
    return text;
}

}  // namespace

std::string report_markdown(const ReportData& data) {
    const std::string name = data.run.value("name", "Results");
    return "# " + plain(name) + "\n\n" + facts(data) + catalogue_markdown(data) +
           reproduction(data) + results(data) + equal_error_markdown(data) + stability(data) +
           references(data) + failures(data);
}

}  // namespace vecino
