// SPDX-License-Identifier: Apache-2.0
#include "eval/reference_quality.h"

#include <algorithm>

#include "eval/commands.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

std::optional<double> own_error(const Json& row, const RegionName& region) {
    Json error = row.value("reference_error", Json());
    if (!region.empty() && error.is_object())
        error = error.value("regions", Json::object()).value(region, Json());
    if (!error.is_object()) return std::nullopt;
    const Json value = error.value("psnr_float_db", Json());
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

const std::optional<Estimate>& quality_of(const GroupSummary& group, const RegionName& region) {
    if (region.empty()) return group.psnr_float_db;
    const auto* const info = std::ranges::find(kRegions, region, &RegionInfo::name);
    return group.region_psnr_float_db[region_index(info->region)];
}

ReferencePart part_of(const ReportData& data, const Json& first, const RegionName& region) {
    ReferencePart part{region, own_error(first, region), {}, "", {}};
    for (const GroupSummary& group : data.groups) {
        const Json& row = data.row_of(group.cells.front());
        const auto& quality = quality_of(group, region);
        if (row.value("reference_file", "") != first["reference_file"] || !quality) continue;
        if (!part.best_db || quality->mean > *part.best_db) {
            part.best_db = quality->mean;
            part.best = group.group;
        }
        if (part.own_db && *part.own_db - quality->mean < kReferenceMargin_db)
            part.too_close.push_back(group.group);
    }
    return part;
}

}  // namespace

std::optional<double> ReferencePart::margin_db() const {
    if (!own_db || !best_db) return std::nullopt;
    return *own_db - *best_db;
}

std::vector<ReferenceQuality> reference_quality(const ReportData& data) {
    std::vector<ReferenceQuality> references;
    for (const Json& row : data.rows) {
        const std::string file = row.value("reference_file", "");
        const auto known = std::ranges::find(references, file, &ReferenceQuality::file);
        if (file.empty() || known != references.end()) continue;
        ReferenceQuality reference{file, row["scene"], reference_text(row), {}};
        reference.parts.push_back(part_of(data, row, ""));
        for (const RegionInfo& info : kRegions) {
            ReferencePart part = part_of(data, row, std::string(info.name));
            if (part.best_db) reference.parts.push_back(std::move(part));
        }
        references.push_back(std::move(reference));
    }
    return references;
}

}  // namespace vecino
