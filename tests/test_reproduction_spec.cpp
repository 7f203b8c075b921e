// SPDX-License-Identifier: Apache-2.0
//
// Reading what a matrix reproduces: faults told in one line each, and the thesis's own part.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "eval/matrix.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/group_summaries.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

const std::string kConfigs = std::string(VECINO_SOURCE_DIR) + "/configs/";

/// A reproduction with one of everything.
Json whole_part() {
    return Json::parse(R"({
        "source": "a book",
        "variants": [{"id": "v", "label": "as printed", "where": {"weighting": "inverse"}}],
        "times_at": {"size": [8, 8]},
        "items": [{"id": "i", "section": "1", "text": "t", "published": 20, "unit": "%",
                   "quantity": "largest_time_share", "of": {"method": "mean"}, "within": 5},
                  {"id": "j", "section": "1", "text": "t", "published": 70, "unit": "h",
                   "quantity": "extrapolated_time", "of": {"method": "path"}, "spp": 4000}],
        "claims": [{"id": "c", "section": "1", "text": "t", "note": "n", "any": true,
                    "tests": [{"quantity": "noise", "of": {"method": "mean"}, "is": "same",
                               "than": {"method": "path"}, "margin_db": 1,
                               "regions": ["edge", "interior"]}]}],
        "graphs": [{"id": "g", "title": "t", "of": {"method": "mean"}}],
        "figures": [{"id": "f", "title": "t", "kind": "strips", "of": [{"method": "path"}]}]})");
}

/// A matrix with a reproduction part that was changed by a JSON patch.
Json patched(const char* patch) {
    Json matrix = reproduction_matrix(whole_part());
    return matrix.patch(Json::parse(patch));
}

Reproduction read(const Json& matrix) {
    return read_reproduction(JsonValue(matrix, "m.json"));
}

const Reproduction& thesis() {
    static const Matrix matrix = load_matrix(kConfigs + "thesis.json");
    static const Reproduction read_once =
        read_reproduction(JsonValue(matrix.document, matrix.file));
    return read_once;
}

/// Every group that the matrix makes, without results.
Groups groups_of(const Matrix& matrix) {
    Groups groups;
    for (const Cell& cell : expand(matrix)) {
        if (!groups.empty() &&
            std::ranges::find(groups, cell.group, &GroupSummary::group) != groups.end())
            continue;
        GroupSummary group;
        group.group = cell.group;
        group.scene = stem(cell.scene);
        group.method = cell.method();
        group.params = cell.parameters_json();
        groups.push_back(std::move(group));
    }
    return groups;
}

template <class Rows>
std::set<std::string> ids_of(const Rows& rows) {
    std::set<std::string> ids;
    for (const auto& row : rows) ids.insert(row.id);
    CHECK(ids.size() == rows.size());
    return ids;
}

}  // namespace

TEST_CASE("a reproduction is read with all that it says", "[reproduction_spec]") {
    const Json matrix = reproduction_matrix(whole_part());
    const Reproduction part = read(matrix);
    CHECK(part.source == "a book");
    REQUIRE(part.variants.size() == 1);
    CHECK(part.variants[0].where.at("weighting") == std::vector<Json>{"inverse"});
    CHECK(part.times_at.names("size"));
    REQUIRE(part.items.size() == 2);
    CHECK(part.items[0].quantity == ItemQuantity::largest_time_share);
    CHECK(part.items[0].published == 20);
    CHECK(part.items[0].within == 5);
    CHECK(part.items[1].unit == "h");
    CHECK(part.items[1].spp == 4000);
    REQUIRE(part.claims.size() == 1);
    CHECK(part.claims[0].any);
    CHECK(part.claims[0].note == "n");
    const ClaimTest& test = part.claims[0].tests.at(0);
    CHECK(test.quantity == Quantity::noise);
    CHECK(test.relation == Relation::same);
    CHECK(test.margin_db == 1);
    CHECK(test.of_region == "edge");
    CHECK(test.than_region == "interior");
    CHECK(part.graphs.at(0).of.names("method"));
    CHECK(part.figures.at(0).kind == FigureKind::strips);
    CHECK(part.figures[0].of.size() == 1);
}

TEST_CASE("a malformed reproduction is refused in one line", "[reproduction_spec]") {
    struct Fault {
        const char* patch;
        const char* message;
    };
    // clang-format off
    const Fault fault = GENERATE(values<Fault>({
        {R"([{"op": "add", "path": "/reproduction/verdicts", "value": 1}])",
         "/reproduction: found unknown key \"verdicts\", allowed: source, variants, times_at, items, claims, graphs, figures"},
        {R"([{"op": "remove", "path": "/reproduction/source"}])",
         "/reproduction: found no key \"source\", allowed: an object that has it"},
        {R"([{"op": "remove", "path": "/reproduction/variants"}])",
         "/reproduction: found no variants, allowed: at least one, as published"},
        {R"([{"op": "replace", "path": "/reproduction/variants", "value": []}])",
         "/reproduction: found no variants, allowed: at least one, as published"},
        {R"([{"op": "add", "path": "/reproduction/variants/0/light", "value": "nee"}])",
         "/reproduction/variants/0: found unknown key \"light\", allowed: id, label, where, tested_at"},
        {R"([{"op": "replace", "path": "/reproduction/variants/0/where/weighting", "value": "far"}])",
         "/reproduction/variants/0/where/weighting: found \"far\", allowed: proportional, inverse, gaussian"},
        {R"([{"op": "copy", "from": "/reproduction/variants/0", "path": "/reproduction/variants/1"}])",
         "/reproduction/variants/1/id: found \"v\", allowed: an id that stands here once"},
        {R"([{"op": "copy", "from": "/reproduction/items/0", "path": "/reproduction/items/1"}])",
         "/reproduction/items/1/id: found \"i\", allowed: an id that stands here once"},
        {R"([{"op": "copy", "from": "/reproduction/claims/0", "path": "/reproduction/claims/1"}])",
         "/reproduction/claims/1/id: found \"c\", allowed: an id that stands here once"},
        {R"([{"op": "copy", "from": "/reproduction/graphs/0", "path": "/reproduction/graphs/1"}])",
         "/reproduction/graphs/1/id: found \"g\", allowed: an id that stands here once"},
        {R"([{"op": "copy", "from": "/reproduction/figures/0", "path": "/reproduction/figures/1"}])",
         "/reproduction/figures/1/id: found \"f\", allowed: an id that stands here once"},
        {R"([{"op": "replace", "path": "/reproduction/items/0/quantity", "value": "speed"}])",
         "/reproduction/items/0/quantity: found \"speed\", allowed: time, largest_time_share, extrapolated_time"},
        {R"([{"op": "replace", "path": "/reproduction/items/0/unit", "value": "min"}])",
         "/reproduction/items/0/unit: found \"min\", allowed: % for a share"},
        {R"([{"op": "replace", "path": "/reproduction/items/1/unit", "value": "days"}])",
         "/reproduction/items/1/unit: found \"days\", allowed: %, min, h"},
        {R"([{"op": "replace", "path": "/reproduction/items/1/unit", "value": "%"}])",
         "/reproduction/items/1/unit: found \"%\", allowed: min, h for a time"},
        {R"([{"op": "remove", "path": "/reproduction/items/0/within"}])",
         "/reproduction/items/0: found no key \"within\", allowed: an object that has it"},
        {R"([{"op": "remove", "path": "/reproduction/items/1/spp"}])",
         "/reproduction/items/1: found no key \"spp\", allowed: an object that has it"},
        {R"([{"op": "replace", "path": "/reproduction/items/1/spp", "value": 0}])",
         "/reproduction/items/1/spp: found 0, allowed: an integer of at least 1"},
        {R"([{"op": "replace", "path": "/reproduction/items/0/published", "value": 0}])",
         "/reproduction/items/0/published: found 0, allowed: a number from 1e-09 to 1e+12"},
        {R"([{"op": "replace", "path": "/reproduction/items/0/of/method", "value": "median"}])",
         "/reproduction/items/0/of/method: found \"median\", allowed: blocky_ceiling, path, "},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests", "value": []}])",
         "/reproduction/claims/0/tests: found [], allowed: at least one test"},
        {R"([{"op": "add", "path": "/reproduction/claims/0/tests/0/margin", "value": 1}])",
         "/reproduction/claims/0/tests/0: found unknown key \"margin\", allowed: quantity, of, is, than, margin_db, regions"},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests/0/quantity", "value": "beauty"}])",
         "/reproduction/claims/0/tests/0/quantity: found \"beauty\", allowed: quality, noise, signature"},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests/0/is", "value": "better"}])",
         "/reproduction/claims/0/tests/0/is: found \"better\", allowed: higher, lower, same"},
        {R"([{"op": "remove", "path": "/reproduction/claims/0/tests/0/margin_db"}])",
         "/reproduction/claims/0/tests/0: found \"is\": \"same\" without a margin, allowed: \"margin_db\" above 0 beside it"},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests/0/margin_db", "value": -1}])",
         "/reproduction/claims/0/tests/0/margin_db: found -1, allowed: a number from 0 to 100"},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests/0/regions", "value": ["edge"]}])",
         "/reproduction/claims/0/tests/0/regions: found [\"edge\"], allowed: two regions: of \"of\" and of \"than\""},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests/0/regions/1", "value": "sky"}])",
         "/reproduction/claims/0/tests/0/regions/1: found \"sky\", allowed: emitter, edge, interior"},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests/0/of", "value": {"scheme": "mean"}}])",
         "/reproduction/claims/0/tests/0/of: found unknown key \"scheme\", allowed: scene, method, budget, size, reduction, spp, "},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/tests/0/of", "value": {"window": [3, 4]}}])",
         "/reproduction/claims/0/tests/0/of/window/1: found 4, allowed: an odd integer from 1 to 9999"},
        {R"([{"op": "replace", "path": "/reproduction/claims/0/any", "value": "yes"}])",
         "/reproduction/claims/0/any: found \"yes\", allowed: true or false"},
        {R"([{"op": "add", "path": "/reproduction/graphs/0/unit", "value": "s"}])",
         "/reproduction/graphs/0: found unknown key \"unit\", allowed: id, title, of"},
        {R"([{"op": "replace", "path": "/reproduction/graphs/0/of", "value": {"budget": "more"}}])",
         "/reproduction/graphs/0/of/budget: found \"more\", allowed: same_spp, equal_samples, thesis_equal_time, equal_time"},
        {R"([{"op": "replace", "path": "/reproduction/figures/0/kind", "value": "film"}])",
         "/reproduction/figures/0/kind: found \"film\", allowed: mosaic, reference, light, strips"},
        {R"([{"op": "replace", "path": "/reproduction/figures/0/of", "value": 3}])",
         "/reproduction/figures/0/of: found 3, allowed: an array"},
    }));
    // clang-format on
    const Json matrix = patched(fault.patch);
    const Error error = error_of([&] { read(matrix); });
    CHECK(std::string(error.what()).starts_with(std::string("m.json: ") + fault.message));
    CHECK(error.code() == ExitCode::usage);
}

TEST_CASE("a variant means the fixed values that it does not name", "[reproduction_spec]") {
    const Json matrix = patched(
        R"([{"op": "add", "path": "/fixed", "value": {"spp": 100, "light_sampling": "none", "seed": 3, "max_depth": 2}},
            {"op": "add", "path": "/axes/max_depth", "value": [1, 2]},
            {"op": "add", "path": "/reproduction/variants/0/where/light_sampling", "value": "nee"}])");
    const Selection where = read(matrix).variants[0].where;
    CHECK(where.at("spp") == std::vector<Json>{100});
    CHECK(where.at("light_sampling") == std::vector<Json>{"nee"});
    // An axis takes the fixed value's place; and results are over seeds.
    CHECK_FALSE(where.names("max_depth"));
    CHECK_FALSE(where.names("seed"));
}

TEST_CASE("a selection compares values as results hold them", "[reproduction_spec]") {
    const Json values = {{"min_normal_cosine", 0.5}, {"use_centre", false}, {"spp", 100.0}};
    const Selection selection = Selection::read(JsonValue(values, "m.json"));
    const Json matrix = Json::parse(
        R"({"name": "m", "axes": {"scene": "a.json", "scheme": "distance3d_normal"}, "reference": {},
            "fixed": {"min_normal_cosine": 0.5, "use_centre": false, "spp": 100}})");
    Matrix loaded;
    loaded.file = "m.json";
    loaded.document = matrix;
    const auto matches_scheme = [&] {
        const auto cells = expand(loaded);
        const auto cell = std::ranges::find(cells, CellKind::scheme, &Cell::kind);
        return cell != cells.end() && selection.matches(cell->parameters_json());
    };
    CHECK(matches_scheme());
    loaded.document["fixed"]["min_normal_cosine"] = 0.25;
    CHECK_FALSE(matches_scheme());
}

TEST_CASE("the thesis's graphs and figures are all there", "[reproduction_spec]") {
    std::set<std::string> figures{"illustration-4", "illustration-6", "overview"};
    for (int i = 20; i <= 42; ++i) figures.insert("figure-" + std::to_string(i));
    std::set<std::string> graphs;
    for (int i = 1; i <= 7; ++i) graphs.insert("graph-" + std::to_string(i));
    CHECK(ids_of(thesis().figures) == figures);
    CHECK(ids_of(thesis().graphs) == graphs);
    const auto kind_of = [](const std::string& id) {
        return std::ranges::find(thesis().figures, id, &Figure::id)->kind;
    };
    CHECK(kind_of("illustration-4") == FigureKind::light);
    CHECK(kind_of("illustration-6") == FigureKind::strips);
    CHECK(kind_of("figure-20") == FigureKind::reference);
    CHECK(kind_of("figure-42") == FigureKind::mosaic);
}

TEST_CASE("the thesis's numbers are all there", "[reproduction_spec]") {
    struct Published {
        const char* section;
        double number;
        const char* unit;
    };
    const Published row = GENERATE(values<Published>({{"5.2", 48.53, "min"},
                                                      {"5.2", 51.44, "min"},
                                                      {"5.2", 78.47, "h"},
                                                      {"5.3.1", 20.87, "%"},
                                                      {"5.3.2", 21.22, "%"},
                                                      {"5.3.3", 26.06, "%"},
                                                      {"5.3.4", 21.36, "%"},
                                                      {"5.3.5", 21.26, "%"},
                                                      {"5.4.1", 83.92, "%"},
                                                      {"5.4.2", 47.12, "min"},
                                                      {"5.4.2", 53.63, "min"},
                                                      {"6.1", 26.06, "%"}}));
    CAPTURE(row.section, row.number);
    CHECK(std::ranges::count_if(thesis().items, [&](const Item& item) {
              return item.section == row.section && item.published == row.number &&
                     item.unit == row.unit;
          }) == 1);
    ids_of(thesis().items);
    for (const Item& item : thesis().items) CHECK(item.within == (item.unit == "%" ? 5.0 : 0.0));
}

TEST_CASE("the thesis's claims are all there", "[reproduction_spec]") {
    const auto ids = ids_of(thesis().claims);
    const std::string id = GENERATE(values<std::string>(
        {"mean-small-windows", "distance3d-ring", "normals-window", "nearest-beats-averages",
         "normals-best", "noise-factor", "nearest-noise-path", "distance2d-definition",
         "distance2d-noise", "normals-noise-path", "normals-noise-edges", "more-samples-same",
         "weighted-noise", "distance-smears", "equal-samples", "equal-time"}));
    CAPTURE(id);
    CHECK(ids.contains(id));
}

TEST_CASE("the thesis's matrices make what their items, claims, graphs and figures speak of",
          "[reproduction_spec]") {
    const std::string name = GENERATE(values<std::string>({"thesis", "thesis-quick"}));
    const Matrix matrix = load_matrix(kConfigs + name + ".json");
    const Reproduction part = read_reproduction(JsonValue(matrix.document, matrix.file));
    const Groups groups = groups_of(matrix);
    const auto finds = [&](const Selection& selection, const Variant& variant) {
        return !select(groups, selection, variant).empty();
    };
    const Variant& printed = part.variants.front();
    for (const Item& item : part.items) CHECK(finds(item.of, printed));
    for (const Graph& graph : part.graphs) CHECK(finds(graph.of, printed));
    for (const Figure& figure : part.figures)
        for (const Selection& of : figure.of)
            if (figure.kind == FigureKind::mosaic) CHECK(finds(of, printed));
    for (const auto& results : evaluate(part, groups).claims) {
        for (const ClaimResult& result : results) {
            // Every pair lacks results here, and a test without pairs is missing beside them.
            CHECK(!result.pairs.empty());
            CHECK(result.missing <= result.pairs.size());
        }
    }
}

TEST_CASE("no claim of the thesis compares a scheme with itself, or one window with another's",
          "[reproduction_spec]") {
    const Groups groups = groups_of(load_matrix(kConfigs + "thesis.json"));
    const ReproductionResult result = evaluate(thesis(), groups);
    for (std::size_t i = 0; i < thesis().claims.size(); ++i) {
        CAPTURE(thesis().claims[i].id);
        const bool by_region =
            thesis().claims[i].tests[0].of_region != thesis().claims[i].tests[0].than_region;
        for (const PairResult& pair : result.claims[i][0].pairs)
            CHECK((pair.of != pair.than) != by_region);
    }
    const auto smears = std::ranges::find(thesis().claims, "distance-smears", &Claim::id);
    const auto& pairs =
        result.claims[static_cast<std::size_t>(smears - thesis().claims.begin())][0].pairs;
    CHECK(pairs.size() == 8);  // 2 scenes, 2 factors, 2 schemes
    for (const PairResult& pair : pairs) {
        std::string than = pair.of;
        than.replace(than.find("w7"), 2, "w3");
        CHECK(pair.than == than);
    }
}
