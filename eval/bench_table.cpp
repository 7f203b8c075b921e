// SPDX-License-Identifier: Apache-2.0
//
// Columns of the benchmark's tables: JSON, text and help from one table each.
#include <algorithm>
#include <span>

#include "eval/bench.h"
#include "eval/commands.h"

namespace vecino {
namespace {

template <class Row>
struct Column {
    std::string_view key;      ///< in JSON
    std::string_view heading;  ///< in the table
    double scale;              ///< from the JSON's unit to the table's
    int digits;
    nlohmann::json (*get)(const Row&);
    std::string_view summary;
};

nlohmann::json or_null(const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
}

constexpr double kMega = 1e-6;
constexpr double kPercent = 100.0;
constexpr double kMilli = 1e3;

// clang-format off
constexpr Column<TraceRow> kTraceColumns[] = {
    {"scene", "scene", 1, 0, [](const TraceRow& r) { return nlohmann::json(r.scene); }, "which was traced"},
    {"light_sampling", "light", 1, 0, [](const TraceRow& r) { return nlohmann::json(r.light_sampling); }, "nee or none"},
    {"simd_width", "width", 1, 0, [](const TraceRow& r) { return nlohmann::json(r.simd_width); }, "samples side by side; 1 is the scalar path"},
    {"samples_per_s", "Msamples/s", kMega, 2, [](const TraceRow& r) { return nlohmann::json(r.samples_per_s.median); }, "paths per second of a render on all threads"},
    {"samples_per_s_spread", "+-%", kPercent, 1, [](const TraceRow& r) { return nlohmann::json(r.samples_per_s.spread); }, "half its range over the rounds, over its median"},
    {"thread_speedup", "x 1 thread", 1, 2, [](const TraceRow& r) { return nlohmann::json(r.thread_speedup); }, "all threads' samples/s over one thread's"},
    {"samples_per_s_one_thread", "1 thread", kMega, 2, [](const TraceRow& r) { return nlohmann::json(r.samples_per_s_one_thread.median); }, "of 128 pixels, by the thread's own clock, as all that follows"},
    {"samples_per_s_one_thread_spread", "+-%", kPercent, 1, [](const TraceRow& r) { return nlohmann::json(r.samples_per_s_one_thread.spread); }, "half its range over the rounds, over its median"},
    {"scalar_speedup", "x scalar", 1, 2, [](const TraceRow& r) { return nlohmann::json(r.scalar_speedup); }, "one thread's samples/s over those of width 1"},
    {"primary_rays_per_s", "primary Mrays/s", kMega, 1, [](const TraceRow& r) { return or_null(r.primary_rays_per_s); }, "rays through Embree alone: from the camera"},
    {"shadow_rays_per_s", "shadow", kMega, 1, [](const TraceRow& r) { return or_null(r.shadow_rays_per_s); }, "the same to lights; null where there are none"},
    {"bounce_rays_per_s", "bounce", kMega, 1, [](const TraceRow& r) { return or_null(r.bounce_rays_per_s); }, "the same for all others"},
    {"rays_per_sample", "rays/sample", 1, 2, [](const TraceRow& r) { return nlohmann::json(r.rays_per_sample); }, "of all kinds"},
    {"embree_share", "Embree %", kPercent, 1, [](const TraceRow& r) { return nlohmann::json(r.embree_share.median); }, "time of the packets alone over that of tracing the same pixels"},
    {"embree_share_spread", "+-%", kPercent, 1, [](const TraceRow& r) { return nlohmann::json(r.embree_share.spread); }, "half its range over the rounds, over its median"},
};

constexpr Column<SchemeRow> kSchemeColumns[] = {
    {"scheme", "scheme", 1, 0, [](const SchemeRow& r) { return nlohmann::json(r.scheme); }, "with its weighting; window 7, to 512x512 pixels"},
    {"reduction", "factor", 1, 0, [](const SchemeRow& r) { return nlohmann::json(r.reduction); }, "from 512 / this"},
    {"time_s", "ms", kMilli, 3, [](const SchemeRow& r) { return nlohmann::json(r.time_s.median); }, "for the image, all threads"},
    {"time_s_spread", "+-%", kPercent, 1, [](const SchemeRow& r) { return nlohmann::json(r.time_s.spread); }, "half its range over the rounds, over its median"},
    {"time_s_one_thread", "1 thread", kMilli, 3, [](const SchemeRow& r) { return nlohmann::json(r.time_s_one_thread.median); }, "by the thread's own clock, as all that follows"},
    {"time_s_one_thread_spread", "+-%", kPercent, 1, [](const SchemeRow& r) { return nlohmann::json(r.time_s_one_thread.spread); }, "half its range over the rounds, over its median"},
    {"time_over_nearest", "x nearest", 1, 2, [](const SchemeRow& r) { return nlohmann::json(r.time_over_nearest); }, "at the same factor"},
    {"time_over_factor_2", "x factor 2", 1, 2, [](const SchemeRow& r) { return nlohmann::json(r.time_over_factor_2); }, "of the same scheme"},
};

constexpr Column<PlanesRow> kPlanesColumns[] = {
    {"scene", "scene", 1, 0, [](const PlanesRow& r) { return nlohmann::json(r.scene); }, "which was traced, with independent samples"},
    {"planes", "planes", 1, 0, [](const PlanesRow& r) { return nlohmann::json(r.planes); }, "that were made"},
    {"time_s", "ms", kMilli, 2, [](const PlanesRow& r) { return nlohmann::json(r.time_s.median); }, "of the render, one thread, by the thread's own clock"},
    {"time_s_spread", "+-%", kPercent, 1, [](const PlanesRow& r) { return nlohmann::json(r.time_s.spread); }, "half its range over the rounds, over its median"},
    {"time_over_radiance", "x radiance", 1, 3, [](const PlanesRow& r) { return nlohmann::json(r.time_over_radiance); }, "over that of radiance alone"},
};
// clang-format on

template <class Row>
std::string cell_text(const Column<Row>& column, const Row& row) {
    const nlohmann::json value = column.get(row);
    if (value.is_null()) return "-";
    if (value.is_string()) return value.get<std::string>();
    return number_text(value.get<double>() * column.scale, column.digits);
}

using TextRow = std::vector<std::string>;

/// Words to the left, numbers to the right, two spaces between.
std::string aligned(const std::vector<TextRow>& rows, const std::vector<bool>& is_number) {
    std::string text;
    for (const TextRow& row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
            std::size_t width = 0;
            for (const TextRow& other : rows) width = std::max(width, other[i].size());
            const std::string padding(width - row[i].size(), ' ');
            text += is_number[i] ? padding + row[i] : row[i] + padding;
            text += i + 1 < row.size() ? "  " : "\n";
        }
    }
    return text;
}

template <class Row>
std::string table(std::span<const Column<Row>> columns, const std::vector<Row>& rows) {
    std::vector<TextRow> text(1);
    std::vector<bool> is_number;
    for (const Column<Row>& column : columns) {
        text.front().emplace_back(column.heading);
        is_number.push_back(!rows.empty() && !column.get(rows.front()).is_string());
    }
    for (const Row& row : rows) {
        text.emplace_back();
        for (const Column<Row>& column : columns) text.back().push_back(cell_text(column, row));
    }
    return aligned(text, is_number);
}

template <class Row>
nlohmann::json rows_json(std::span<const Column<Row>> columns, const std::vector<Row>& rows) {
    nlohmann::json json = nlohmann::json::array();
    for (const Row& row : rows) {
        nlohmann::json object;
        for (const Column<Row>& column : columns) object[std::string(column.key)] = column.get(row);
        json.push_back(std::move(object));
    }
    return json;
}

template <class Row>
std::string keys_text(std::string_view name, std::span<const Column<Row>> columns) {
    std::string text = std::string(name) + ":\n";
    for (const Column<Row>& column : columns) {
        std::string line = "  " + std::string(column.key);
        line.resize(std::max<std::size_t>(line.size() + 1, 35), ' ');
        text += line + std::string(column.summary) + "\n";
    }
    return text;
}

template <class Row, std::size_t N>
std::span<const Column<Row>> all(const Column<Row> (&columns)[N]) {
    return columns;
}

}  // namespace

nlohmann::json bench_json(const BenchReport& report) {
    return {{"tracing", rows_json(all(kTraceColumns), report.tracing)},
            {"schemes", rows_json(all(kSchemeColumns), report.schemes)},
            {"planes", rows_json(all(kPlanesColumns), report.planes)}};
}

std::string bench_text(const BenchReport& report) {
    std::string text;
    const auto add = [&text](const std::string& part) {
        text += (text.empty() ? "" : "\n") + part;
    };
    if (!report.tracing.empty()) add(table(all(kTraceColumns), report.tracing));
    if (!report.schemes.empty()) add(table(all(kSchemeColumns), report.schemes));
    if (!report.planes.empty()) add(table(all(kPlanesColumns), report.planes));
    return text;
}

std::string bench_key_text() {
    return keys_text("tracing", all(kTraceColumns)) + keys_text("schemes", all(kSchemeColumns)) +
           keys_text("planes", all(kPlanesColumns));
}

}  // namespace vecino
