// SPDX-License-Identifier: Apache-2.0
#include "eval/cell_vti.h"

#include <filesystem>
#include <optional>

#include "eval/comparison_vti.h"
#include "eval/loaded_frame.h"
#include "eval/name_pattern.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

std::string image_path(const ReportData& data, const Json& row) {
    return data.directory + "/cells/" + row["cell"].get<std::string>() + "/image.exr";
}

std::string reference_path(const ReportData& data, const Json& row) {
    return data.directory + "/" + row.value("reference_file", "") + ".exr";
}

/// The reference of the last cell: neighbours in a run share theirs.
struct SharedReference {
    std::string path;
    Frame frame;
    std::optional<RegionMap> regions;

    void load(const std::string& new_path) {
        if (path == new_path) return;
        frame = load_planes(new_path).frame;
        regions.reset();
        if (has_region_planes(frame)) regions = regions_of(frame);
        path = new_path;
    }
};

}  // namespace

std::vector<const Json*> selected_rows(const ReportData& data, const std::string& only) {
    const NamePattern pattern(only);
    std::vector<const Json*> rows;
    for (const Json& row : data.rows) {
        if (pattern.matches(row["cell"].get<std::string>())) rows.push_back(&row);
    }
    if (rows.empty()) pattern.fail_without_match();
    return rows;
}

bool has_images(const ReportData& data, const Json& row) {
    return std::filesystem::exists(image_path(data, row)) &&
           std::filesystem::exists(reference_path(data, row));
}

void write_cell_vtis(const ReportData& data, const std::vector<const Json*>& rows,
                     const std::function<std::string(const std::string& cell)>& path_of) {
    SharedReference reference;
    for (const Json* row : rows) {
        if (!has_images(data, *row)) continue;
        reference.load(reference_path(data, *row));
        const Frame test = load_planes(image_path(data, *row)).frame;
        save_comparison_vti(
            {test, reference.frame, reference.regions ? &*reference.regions : nullptr,
             row->value("metrics", Json::object())},
            path_of((*row)["cell"]));
    }
}

}  // namespace vecino
