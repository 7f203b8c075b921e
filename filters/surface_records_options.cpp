// SPDX-License-Identifier: Apache-2.0
//
// The rows of the table of method options that surface_records reads.
#include "filters/surface_records_options.h"

#include <charconv>
#include <string>
#include <vector>

#include "core/json_schema.h"
#include "core/named_values.h"
#include "filters/method_rows.h"

namespace vecino {
namespace {

constexpr IntegerKind kSpp{1, 4096};
constexpr IntegerKind kEdgeSpp{0, 65536};
constexpr IntegerKind kCell{1, 256};
constexpr IntegerKind kLevels{0, 8};
constexpr IntegerKind kPaths{1, 1 << 20};
constexpr IntegerKind kOrder{0, 2};
constexpr Named<EdgeLight> kEdgeLights[] = {{"records", EdgeLight::records},
                                            {"paths", EdgeLight::paths}};
constexpr ChoiceKind kEdgeLight{kEdgeLights};
/// In double, which prints as it was given.
struct NumberKind {
    NumberRange range;
    [[nodiscard]] double read(const JsonValue& json) const { return json.number(range); }
    [[nodiscard]] nlohmann::json schema() const { return RealKind{range}.schema(); }
};
constexpr NumberKind kPositive{{1e-3, 1e3}};

using Options = SurfaceRecordsOptions;

bool is_auto(const JsonValue& json) {
    return json.raw().is_string() && json.raw() == "auto";
}

template <const auto& kKind, auto kMember>
void set(MethodParameters& parameters, const JsonValue& json) {
    auto& value = parameters.surface_records.*kMember;
    if (is_auto(json)) {
        value.reset();
    } else {
        value = kKind.read(json);
    }
}

template <auto kMember>
nlohmann::json get(const MethodParameters& parameters) {
    const auto& value = parameters.surface_records.*kMember;
    if (!value) return "auto";
    return *value;
}

/// The fewest digits that read back as the same number.
std::string text_of(double value) {
    char digits[32];
    const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), value);
    return {digits, end};
}

// Names of cells are short: "pilot8".
template <auto kMember, const char* kPrefix>
std::string slug(const MethodParameters& parameters) {
    const auto& value = parameters.surface_records.*kMember;
    return kPrefix + (value ? text_of(static_cast<double>(*value)) : "_auto");
}

template <const auto& kKind>
nlohmann::json schema() {
    return {{"oneOf", nlohmann::json::array({kKind.schema(), {{"const", "auto"}}})}};
}

template <const auto& kKind, auto kMember, const char* kPrefix>
constexpr MethodOption row(std::string_view name, std::string_view flag, std::string_view allowed,
                           std::string_view summary) {
    return {name,
            flag,
            allowed,
            summary,
            set<kKind, kMember>,
            get<kMember>,
            slug<kMember, kPrefix>,
            schema<kKind>};
}

nlohmann::json get_edge_light(const MethodParameters& parameters) {
    const auto& value = parameters.surface_records.edge_light;
    return value ? name_of(kEdgeLights, *value) : "auto";
}

std::string edge_light_slug(const MethodParameters& parameters) {
    return "edges_" + get_edge_light(parameters).get<std::string>();
}

constexpr char kPilot[] = "pilot", kEdge[] = "edge", kCellSlug[] = "cell", kLevelSlug[] = "lev",
               kRecord[] = "paths", kRefined[] = "fine", kSigma[] = "sigma", kTau[] = "tau",
               kOrderSlug[] = "order";

// clang-format off
const MethodOption kRows[] = {
    row<kSpp, &Options::pilot_spp, kPilot>("pilot_spp", "--pilot-spp", "an integer from 1 to 4096, or auto",
        "first samples of every pixel"),
    row<kEdgeSpp, &Options::edge_spp, kEdge>("edge_spp", "--edge-spp", "an integer from 0 to 65536, or auto",
        "mean number of samples of a pixel at an edge or in half-shadow"),
    row<kCell, &Options::cell, kCellSlug>("cell", "--cell", "an integer from 1 to 256, or auto",
        "side of the cells with one record per surface, pixels"),
    row<kLevels, &Options::levels, kLevelSlug>("levels", "--levels", "an integer from 0 to 8, or auto",
        "how often a cell may be halved"),
    row<kPaths, &Options::record_paths, kRecord>("record_paths", "--record-paths", "an integer from 1 to 1048576, or auto",
        "paths of each record"),
    row<kPaths, &Options::refined_record_paths, kRefined>("refined_record_paths", "--refined-record-paths",
        "an integer from 1 to 1048576, or auto", "paths of each record in a halved cell"),
    row<kPositive, &Options::fit_sigma, kSigma>("fit_sigma", "--fit-sigma", "a number from 0.001 to 1000, or auto",
        "standard deviation of the window that records are fitted in, cells"),
    row<kPositive, &Options::refine_tau, kTau>("refine_tau", "--refine-tau", "a number from 0.001 to 1000, or auto",
        "a cell is halved if it is larger than this share of the distance to what is around it"),
    row<kOrder, &Options::fit_order, kOrderSlug>("fit_order", "--fit-order", "an integer from 0 to 2, or auto",
        "of the polynomials between records, at most"),
    {"edge_light", "--edge-light", "records, paths, or auto", "indirect light of pixels that surfaces share; paths know of the finest contacts",
     set<kEdgeLight, &Options::edge_light>, get_edge_light, edge_light_slug, schema<kEdgeLight>},
};
// clang-format on

template <class T>
void put(const std::optional<T>& from, T& to) {
    if (from) to = *from;
}

}  // namespace

SurfaceRecordsPlan plan_of(const SurfaceRecordsOptions& options, int spp) {
    SurfaceRecordsPlan plan = surface_records_plan(spp);
    put(options.pilot_spp, plan.pilot_spp);
    put(options.edge_spp, plan.edge_spp);
    put(options.cell, plan.cell);
    put(options.levels, plan.levels);
    put(options.record_paths, plan.record_paths);
    put(options.refined_record_paths, plan.refined_record_paths);
    put(options.fit_sigma, plan.fit_sigma);
    put(options.refine_tau, plan.refine_tau);
    put(options.fit_order, plan.fit_order);
    put(options.edge_light, plan.edge_light);
    return plan;
}

std::span<const MethodOption> surface_records_rows() {
    return kRows;
}

MethodRender method_render(StagedRender staged) {
    const StageTimes& times = staged.times;
    const SurfaceRecordsPlan& plan = staged.plan;
    MethodRender out{.render = std::move(staged.render)};
    out.reconstruct_s = times.fit_s + times.needs_s + times.resolve_s;
    out.render.statistics.trace_s -= out.reconstruct_s;
    out.facts = {{"pilot_spp", plan.pilot_spp},
                 {"edge_spp", plan.edge_spp},
                 {"cell", plan.cell},
                 {"levels", plan.levels},
                 {"record_paths", plan.record_paths},
                 {"refined_record_paths", plan.refined_record_paths},
                 {"fit_sigma", plan.fit_sigma},
                 {"refine_tau", plan.refine_tau},
                 {"fit_order", plan.fit_order},
                 {"edge_light", name_of(kEdgeLights, plan.edge_light)},
                 {"needy_pixels", staged.counts.needy_pixels},
                 {"records", staged.counts.records}};
    out.stage_s = {{"pilot", times.pilot_s},     {"records", times.records_s},
                   {"fit", times.fit_s},         {"needs", times.needs_s},
                   {"samples", times.samples_s}, {"resolve", times.resolve_s}};
    if (times.trials_s > 0) out.stage_s["trials"] = times.trials_s;
    return out;
}

MethodRender run_surface_records(const MethodRequest& request, const Progress& progress) {
    const SurfaceRecordsPlan plan =
        plan_of(request.parameters.surface_records, request.settings.spp);
    return method_render(render_in_stages(request.scene, request.settings, {plan}, progress));
}

}  // namespace vecino
