// SPDX-License-Identifier: Apache-2.0
#include "eval/stability_summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "core/image_io.h"
#include "core/parallel.h"
#include "core/render.h"
#include "eval/reference_error.h"

namespace vecino {
namespace {

using Json = nlohmann::json;
using Rows = std::vector<const Json*>;

bool is_ok(const Json& row) {
    return row.value("status", "") == "ok";
}

/// Rows by group, of the groups that have what the stability of a cell is made of.
std::map<std::string, Rows> measured_groups(const std::vector<Json>& rows) {
    std::map<std::string, Rows> groups;
    for (const Json& row : rows) groups[row["group"]].push_back(&row);
    std::erase_if(groups, [](const auto& entry) {
        return std::ranges::none_of(entry.second, [](const Json* row) {
            return row->value("stability", Json()).is_object();
        });
    });
    return groups;
}

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

void add_spread(const Rows& rows, GroupStability& result) {
    std::vector<double> values;
    for (const Json* row : rows) {
        const Json value = row->value("metrics", Json::object()).value("psnr_float_db", Json());
        if (is_ok(*row) && value.is_number()) values.push_back(value.get<double>());
    }
    if (values.empty()) return;
    result.worst_db = std::ranges::min(values);
    if (values.size() < 2) return;
    const double mean = mean_of(values);
    double squares = 0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    result.spread_db = std::sqrt(squares / static_cast<double>(values.size() - 1));
}

void add_counts(const Rows& rows, GroupStability& result) {
    for (const Json* row : rows) {
        if (!is_ok(*row)) ++result.failed;
        const Json counts = row->value("counts", Json::object());
        result.dropped_samples += counts.value("dropped_samples", std::size_t{0});
        result.non_finite_pixels += counts.value("non_finite_pixels", std::size_t{0});
        const Json params = row->value("params", Json::object());
        const auto size = params.value("size", std::array<int, 2>{1, 1});
        const Extent low = reduced({size[0], size[1]}, params.value("reduction", 1));
        const auto fallback = counts.value("fallback_pixels", 0.0);
        result.fallback_share =
            std::max(result.fallback_share, fallback / static_cast<double>(low.area()));
    }
}

/// Of one seed; none where an error is 0.
std::optional<Elasticity> elasticity_of(const Json& both) {
    if (!both.is_object()) return std::nullopt;
    const auto number = [&](const char* which, const char* key) {
        const Json end = both.value(which, Json::object());
        return end.is_object() ? end.value(key, 0.0) : 0.0;
    };
    const double errors = std::log(number("high", "mse") / number("low", "mse"));
    const double values = std::log(number("high", "value") / number("low", "value"));
    if (!std::isfinite(errors) || !std::isfinite(values) || values == 0) return std::nullopt;
    return Elasticity{number("low", "value"), number("high", "value"), errors / values};
}

void add_elasticity(const Rows& rows, GroupStability& result) {
    std::map<std::string, std::vector<double>> by_seed;
    for (const Json* row : rows) {
        const Json all = row->value("stability", Json::object()).value("elasticity", Json());
        if (!all.is_object()) continue;
        for (const auto& [parameter, both] : all.items()) {
            const auto measured = elasticity_of(both);
            if (!measured) continue;
            by_seed[parameter].push_back(measured->value);
            result.elasticity[parameter] = {measured->low, measured->high,
                                            mean_of(by_seed[parameter])};
        }
    }
}

/// The images of one camera, by seed; empty if one is gone.
std::vector<Image> images_of(const RunDirectory& directory, const Rows& rows,
                             const std::string& file) {
    std::vector<Image> images;
    for (const Json* row : rows) {
        const std::string path =
            directory.file("cells/" + (*row)["cell"].get<std::string>() + "/" + file);
        if (!std::filesystem::exists(path)) return {};
        images.push_back(load_image(path));
    }
    return images;
}

/// What a row says of one shift.
struct Change {
    double shift = 0;
    double of_image = 0, of_reference = 0;
};

/// Empty where the row does not say it, or not as this program does.
std::vector<Change> changes_of(const Json& row) {
    std::vector<Change> changes;
    const Json stability = row.value("stability", Json());
    if (!stability.is_object() || !is_ok(row)) return changes;
    for (const Json& each : stability.value("shimmer", Json::array())) {
        if (!each.is_object()) return {};
        changes.push_back({each.value("shift", 0.0), each.value("change", 0.0),
                           each.value("reference_change", 0.0)});
    }
    return changes;
}

/// Without the images, which tell noise from the rest.
Shimmer from_rows(const Rows& rows, std::size_t index) {
    Change sum;
    for (const Json* row : rows) {
        const Change change = changes_of(*row)[index];
        sum.of_image += change.of_image;
        sum.of_reference += change.of_reference;
    }
    return {changes_of(*rows.front())[index].shift, sum.of_image / sum.of_reference, {}};
}

/// The references' own noise, against what changes between them.
bool is_limited(const Json& row, double reference_change) {
    const Json error = row.value("reference_error", Json());
    const Json own = error.is_object() ? error.value("psnr_float_db", Json()) : Json();
    return own.is_number() && 2 * mse_of(own.get<double>()) > 0.1 * reference_change;
}

void add_shimmer(const RunDirectory& directory, const Rows& all, GroupStability& result) {
    Rows rows;
    std::ranges::copy_if(all, std::back_inserter(rows),
                         [](const Json* row) { return !changes_of(*row).empty(); });
    if (rows.empty()) return;
    const std::vector<Change> changes = changes_of(*rows.front());
    for (const Json* row : rows)
        if (changes_of(*row).size() != changes.size()) return;
    const std::vector<Image> images = images_of(directory, rows, "image.exr");
    for (std::size_t i = 0; i < changes.size(); ++i) {
        const auto& [shift, of_image, of_reference] = changes[i];
        if (!(of_reference > 0)) continue;
        const std::vector<Image> shifted = images_of(directory, rows, shifted_image_file(shift));
        const bool has_images = !images.empty() && images.size() == shifted.size();
        result.shimmer.push_back(has_images ? *shimmer(images, shifted, shift, of_reference)
                                            : from_rows(rows, i));
        result.is_limited |= is_limited(*rows.front(), of_reference);
    }
}

Json number_or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

}  // namespace

std::vector<StabilityInfo> stability_columns() {
    return {
        {"spread", "sample standard deviation of psnr_float_db over seeds, dB"},
        {"worst seed", "least psnr_float_db of a seed, dB"},
        {"shimmer",
         "what changes in the image as the camera moves by this part of a pixel, right and down, "
         "over what changes in the reference: mean of a b / mean of r^2 with a and b the changes "
         "of two seeds' images and r that of the references, in display values; in brackets with "
         "the noise that changes too, mean of a^2 / mean of r^2. 1 is right, more is change that "
         "the scene does not have, less is change that is lost. ≈R: the references' noise could "
         "be a tenth of r^2"},
        {"elasticity",
         "per cent of mean squared error (display values) for one per cent of the parameter, from "
         "half of it to one and a half: 0 needs no tuning"},
        {"fallback",
         "traced pixels that kept their own colour, since their weights summed to 0 or nothing was "
         "hit: largest share of all seeds"},
        {"dropped", "samples that were not finite, over all seeds"},
        {"non-finite", "pixels of which nothing finite was left, over all seeds"},
    };
}

std::map<std::string, GroupStability> group_stability(const RunDirectory& directory,
                                                      const std::vector<Json>& rows) {
    std::map<std::string, GroupStability> result;
    std::vector<std::pair<const Rows*, GroupStability*>> work;
    const auto groups = measured_groups(rows);
    for (const auto& [name, members] : groups) work.emplace_back(&members, &result[name]);
    for_each_block(work.size(), 1, 0, [&](BlockRange block) {
        const auto& [members, stability] = work[block.begin];
        add_spread(*members, *stability);
        add_counts(*members, *stability);
        add_elasticity(*members, *stability);
        add_shimmer(directory, *members, *stability);
    });
    return result;
}

Json group_stability_json(const GroupStability& s) {
    Json json{{"spread_db", number_or_null(s.spread_db)},
              {"worst_db", number_or_null(s.worst_db)},
              {"limited_by_reference", s.is_limited},
              {"fallback_share", s.fallback_share},
              {"dropped_samples", s.dropped_samples},
              {"non_finite_pixels", s.non_finite_pixels},
              {"failed", s.failed},
              {"shimmer", Json::array()},
              {"elasticity", Json::object()}};
    for (const Shimmer& each : s.shimmer) {
        json["shimmer"].push_back({{"shift", each.shift},
                                   {"with_noise", each.with_noise},
                                   {"without_noise", number_or_null(each.without_noise)}});
    }
    for (const auto& [parameter, each] : s.elasticity)
        json["elasticity"][parameter] = {
            {"low", each.low}, {"high", each.high}, {"value", each.value}};
    return json;
}

}  // namespace vecino
