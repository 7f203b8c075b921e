// SPDX-License-Identifier: Apache-2.0
#include "eval/group_statistics.h"

#include <filesystem>
#include <optional>

#include "core/error.h"
#include "core/files.h"
#include "core/image_io.h"
#include "core/parallel.h"
#include "eval/reference_store.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

/// A group whose cells are all finished, and what decides their images.
struct Group {
    std::string name, key, reference;
    std::vector<std::string> cells;
    std::optional<SeedStatisticsByRegion> statistics;
};

std::vector<Group> finished_groups(const std::vector<Json>& rows) {
    std::vector<Group> groups;
    std::map<std::string, std::size_t> index;
    std::map<std::string, bool> is_whole;
    for (const Json& row : rows) {
        const std::string name = row["group"];
        const auto [entry, is_new] = index.try_emplace(name, groups.size());
        if (is_new) groups.push_back({name, "", row.value("reference_file", ""), {}, {}});
        Group& group = groups[entry->second];
        const bool is_ok =
            row.value("status", "") == "ok" && row.value("reference_file", "") == group.reference;
        is_whole.try_emplace(name, true).first->second &= is_ok;
        group.cells.push_back(row["cell"]);
        for (const char* part : {"params", "reference", "scene_hash", "build"})
            group.key += row.value(part, Json()).dump();
    }
    std::erase_if(groups, [&](const Group& group) { return !is_whole[group.name]; });
    for (Group& group : groups) group.key = text_hash(group.key + group.reference);
    return groups;
}

Json read_kept(const std::string& path) {
    if (!std::filesystem::exists(path)) return Json::object();
    const Json kept = Json::parse(read_file(path), nullptr, false);
    return kept.is_object() ? kept : Json::object();
}

std::optional<SeedStatisticsByRegion> kept_statistics(const Json& kept, const Group& group) {
    const auto entry = kept.find(group.name);
    if (entry == kept.end() || !entry->is_object()) return std::nullopt;
    if (entry->value("key", Json()) != group.key) return std::nullopt;
    const Json statistics = entry->value("statistics", Json());
    try {
        return read_seed_statistics(JsonValue(statistics, "statistics.json"));
    } catch (const Error&) {
        return std::nullopt;  // another version of the program kept something else there
    }
}

struct Reference {
    Image image;
    std::optional<RegionMap> regions;
};

Reference load_reference(const std::string& path) {
    Frame frame = load_frame(path);
    Reference reference;
    if (has_region_planes(frame)) reference.regions = regions_of(frame);
    reference.image = std::move(frame.radiance);
    return reference;
}

void measure(Group& group, const Reference& reference, const RunDirectory& directory) {
    std::vector<Image> images;
    for (const std::string& cell : group.cells) {
        const std::string file = directory.file("cells/" + cell + "/image.exr");
        if (!std::filesystem::exists(file)) return;
        images.push_back(load_image(file));
    }
    group.statistics =
        seed_statistics(images, reference.image, reference.regions ? &*reference.regions : nullptr);
}

}  // namespace

std::map<std::string, SeedStatisticsByRegion> group_statistics(const RunDirectory& directory,
                                                               const std::vector<Json>& rows) {
    const std::string path = directory.file("statistics.json");
    const Json kept = read_kept(path);
    std::vector<Group> groups = finished_groups(rows);
    std::map<std::string, Reference> references;
    std::vector<Group*> pending;
    for (Group& group : groups) {
        group.statistics = kept_statistics(kept, group);
        const std::string file = directory.file(group.reference + ".exr");
        if (group.statistics || !std::filesystem::exists(file)) continue;
        if (!references.contains(group.reference))
            references.emplace(group.reference, load_reference(file));
        pending.push_back(&group);
    }
    for_each_block(pending.size(), 1, 0, [&](BlockRange block) {
        Group& group = *pending[block.begin];
        measure(group, references.at(group.reference), directory);
    });

    std::map<std::string, SeedStatisticsByRegion> result;
    Json now = Json::object();
    for (Group& group : groups) {
        if (!group.statistics) continue;
        now[group.name] = {{"key", group.key},
                           {"statistics", seed_statistics_json(*group.statistics)}};
        result.emplace(group.name, std::move(*group.statistics));
    }
    if (now != kept) write_text_file(path, now.dump() + "\n");
    return result;
}

}  // namespace vecino
