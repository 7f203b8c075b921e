// SPDX-License-Identifier: Apache-2.0
#include "eval/reproduction_spec.h"

#include <algorithm>
#include <set>

#include "core/named_values.h"
#include "eval/regions.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

constexpr Named<Quantity> kQuantities[] = {
    {"quality", Quantity::quality},
    {"noise", Quantity::noise},
    {"signature", Quantity::signature},
};
constexpr Named<Relation> kRelations[] = {
    {"higher", Relation::higher},
    {"lower", Relation::lower},
    {"same", Relation::same},
};
constexpr Named<ItemQuantity> kItemQuantities[] = {
    {"time", ItemQuantity::time},
    {"largest_time_share", ItemQuantity::largest_time_share},
    {"extrapolated_time", ItemQuantity::extrapolated_time},
};
constexpr Named<FigureKind> kFigureKinds[] = {
    {"mosaic", FigureKind::mosaic},
    {"reference", FigureKind::reference},
    {"light", FigureKind::light},
    {"strips", FigureKind::strips},
};
constexpr NumberRange kPositive{1e-9, 1e12};
constexpr NumberRange kMargin{0.0, 100.0};

Selection selection_at(const JsonValue& json, std::string_view key) {
    return json.has(key) ? Selection::read(json.at(key)) : Selection();
}

Variant read_variant(const JsonValue& json) {
    json.require_keys({"id", "label", "where", "tested_at"});
    return {json.at("id").string(), json.at("label").string(), selection_at(json, "where"),
            selection_at(json, "tested_at")};
}

bool is_region_name(std::string_view name) {
    return std::ranges::find(kRegions, name, &RegionInfo::name) != kRegions.end();
}

std::string region_names() {
    std::vector<std::string_view> names;
    for (const RegionInfo& region : kRegions) names.push_back(region.name);
    return join(names);
}

/// [of, than]
void read_regions(const JsonValue& json, ClaimTest& test) {
    const auto names = json.elements();
    if (names.size() != 2) json.fail("two regions: of \"of\" and of \"than\"");
    for (const JsonValue& name : names) {
        if (!is_region_name(name.string())) name.fail(region_names());
    }
    test.of_region = names[0].string();
    test.than_region = names[1].string();
}

ClaimTest read_test(const JsonValue& json) {
    json.require_keys({"quantity", "of", "is", "than", "margin_db", "regions"});
    ClaimTest test;
    test.quantity = value_of(kQuantities, json.at("quantity"));
    test.of = Selection::read(json.at("of"));
    test.relation = value_of(kRelations, json.at("is"));
    test.than = Selection::read(json.at("than"));
    if (json.has("margin_db")) test.margin_db = json.at("margin_db").number(kMargin);
    if (json.has("regions")) read_regions(json.at("regions"), test);
    if (test.relation == Relation::same && !(test.margin_db > 0))
        json.fail("\"is\": \"same\" without a margin", "\"margin_db\" above 0 beside it");
    return test;
}

Claim read_claim(const JsonValue& json) {
    json.require_keys({"id", "section", "text", "note", "tests", "any"});
    Claim claim;
    claim.id = json.at("id").string();
    claim.section = json.at("section").string();
    claim.text = json.at("text").string();
    if (json.has("note")) claim.note = json.at("note").string();
    if (json.has("any")) claim.any = json.at("any").boolean();
    for (const JsonValue& test : json.at("tests").elements())
        claim.tests.push_back(read_test(test));
    if (claim.tests.empty()) json.at("tests").fail("at least one test");
    return claim;
}

/// A share and a time are no numbers of each other's kind.
std::string read_unit(const JsonValue& json, ItemQuantity quantity) {
    const std::string unit = json.string();
    if (unit != "%" && unit != "min" && unit != "h") json.fail("%, min, h");
    const bool is_share = quantity == ItemQuantity::largest_time_share;
    if (is_share != (unit == "%")) json.fail(is_share ? "% for a share" : "min, h for a time");
    return unit;
}

Item read_item(const JsonValue& json) {
    json.require_keys(
        {"id", "section", "text", "note", "published", "unit", "quantity", "of", "within", "spp"});
    Item item;
    item.id = json.at("id").string();
    item.section = json.at("section").string();
    item.text = json.at("text").string();
    if (json.has("note")) item.note = json.at("note").string();
    item.published = json.at("published").number(kPositive);
    item.quantity = value_of(kItemQuantities, json.at("quantity"));
    item.unit = read_unit(json.at("unit"), item.quantity);
    item.of = Selection::read(json.at("of"));
    if (item.quantity == ItemQuantity::largest_time_share)
        item.within = json.at("within").number(kPositive);
    if (item.quantity == ItemQuantity::extrapolated_time)
        item.spp = json.at("spp").integer(1, 2147483647);
    return item;
}

Graph read_graph(const JsonValue& json) {
    json.require_keys({"id", "title", "of"});
    return {json.at("id").string(), json.at("title").string(), Selection::read(json.at("of"))};
}

Figure read_figure(const JsonValue& json) {
    json.require_keys({"id", "title", "kind", "of"});
    Figure figure{json.at("id").string(), json.at("title").string(), FigureKind::mosaic, {}};
    if (json.has("kind")) figure.kind = value_of(kFigureKinds, json.at("kind"));
    if (!json.has("of")) return figure;
    const JsonValue of = json.at("of");
    if (of.raw().is_object()) {
        figure.of.push_back(Selection::read(of));
    } else {
        for (const JsonValue& each : of.elements()) figure.of.push_back(Selection::read(each));
    }
    return figure;
}

/// Ids are what reports and other programs refer to.
template <class Row>
std::vector<Row> read_rows(const JsonValue& json, std::string_view key,
                           Row (*read)(const JsonValue&)) {
    std::vector<Row> rows;
    if (!json.has(key)) return rows;
    std::set<std::string> ids;
    for (const JsonValue& each : json.at(key).elements()) {
        rows.push_back(read(each));
        if (!ids.insert(rows.back().id).second) each.at("id").fail("an id that stands here once");
    }
    return rows;
}

/// Fixed values of a render, as a selection. A variant that says nothing about one means it. An
/// axis takes a fixed value's place in all cells; and results are over all seeds.
Selection fixed_selection(const JsonValue& matrix) {
    if (!matrix.has("fixed")) return {};
    nlohmann::json fixed = nlohmann::json::object();
    for (const RenderOption& row : render_options()) {
        const bool is_axis = row.name == "seed" || matrix.at("axes").has(row.name);
        const bool given = matrix.at("fixed").has(row.name);
        if (given && !is_axis) fixed[std::string(row.name)] = matrix.at("fixed").at(row.name).raw();
    }
    return Selection::read(JsonValue(fixed, matrix.file(), "/fixed"));
}

}  // namespace

Variant Variant::tested() const {
    Variant result{id, label, tested_at, {}};
    result.where.add_missing(where);
    return result;
}

Reproduction read_reproduction(const JsonValue& matrix) {
    const JsonValue json = matrix.at("reproduction");
    json.require_keys({"source", "variants", "times_at", "items", "claims", "graphs", "figures"});
    Reproduction result;
    result.source = json.at("source").string();
    result.variants = read_rows(json, "variants", read_variant);
    if (result.variants.empty()) json.fail("no variants", "at least one, as published");
    const Selection fixed = fixed_selection(matrix);
    for (Variant& variant : result.variants) variant.where.add_missing(fixed);
    result.times_at = selection_at(json, "times_at");
    result.items = read_rows(json, "items", read_item);
    result.claims = read_rows(json, "claims", read_claim);
    result.graphs = read_rows(json, "graphs", read_graph);
    result.figures = read_rows(json, "figures", read_figure);
    return result;
}

}  // namespace vecino
