// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/files.h"
#include "core/image_io.h"
#include "eval/commands.h"
#include "eval/error_map.h"
#include "eval/metrics.h"
#include "eval/metrics_json.h"
#include "eval/reference_error.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

struct CompareArguments {
    std::string test;
    std::string reference;
    std::string error_map;
    std::string error_kind = "magnitude";
    std::optional<double> min_psnr, min_ssim, max_relmse;
    std::vector<std::string> metrics;
    bool json = false;
};

void require_map_extension(const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    if (path.empty() || extension == ".png" || extension == ".exr") return;
    throw Error(ExitCode::usage,
                "--error-map: found \"" + path + "\", allowed: a name that ends in .png or .exr");
}

void write_error_map(const CompareArguments& arguments, const Image& test, const Image& reference) {
    const std::string& path = arguments.error_map;
    if (path.empty()) return;
    if (std::filesystem::path(path).extension() == ".exr") {
        save_image(difference(test, reference), path);
        return;
    }
    const ErrorKind kind = arguments.error_kind == "sign" ? ErrorKind::sign : ErrorKind::magnitude;
    const Grid<float> values = error_values(test, reference, kind);
    const std::string title = std::filesystem::path(arguments.test).filename().string() + " - " +
                              std::filesystem::path(arguments.reference).filename().string();
    save_raster(error_picture(values, {kind, suggested_range(values), title}), path);
}

std::string non_finite_text(const CompareArguments& arguments, const NonFinite& found) {
    const std::string& file = found.in_test ? arguments.test : arguments.reference;
    return file + ": " + std::to_string(found.count) +
           " values are not finite (both images), the first at (" + std::to_string(found.x) + ", " +
           std::to_string(found.y) + ") channel " + std::to_string(found.channel) + ": not scored";
}

std::string value_text(const std::optional<double>& value) {
    return value ? number_text(*value, 5) : "-";
}

std::string number_of(const nlohmann::json& value, int digits) {
    return value.is_number() ? number_text(value.get<double>(), digits) : "-";
}

/// A column per region below the metrics of the whole image.
void print_regions(const PerRegion<RegionMetrics>& regions) {
    const auto print_row = [&](std::string_view name, auto text_of) {
        std::printf("%-14s", std::string(name).c_str());
        for (const RegionInfo& info : kRegions)
            std::printf(" %12s", text_of(info, regions[region_index(info.region)]).c_str());
        std::printf("\n");
    };
    std::printf("\n");
    print_row("region", [](const RegionInfo& info, auto&) { return std::string(info.name); });
    print_row("pixels", [](auto&, const RegionMetrics& r) { return std::to_string(r.pixels); });
    for (const MetricInfo& metric : all_metrics()) {
        const bool has_value = std::ranges::any_of(
            regions, [&](const RegionMetrics& r) { return r.metrics && metric.value(*r.metrics); });
        if (!has_value && metric.is_on_request) continue;
        print_row(metric.name, [&](auto&, const RegionMetrics& r) {
            return value_text(r.metrics ? metric.value(*r.metrics) : std::nullopt);
        });
    }
    for (const RegionInfo& info : kRegions)
        std::printf("%s: %s\n", std::string(info.name).c_str(),
                    std::string(info.definition).c_str());
}

void print_metrics(const Comparison& comparison) {
    if (!comparison.metrics) return;
    const Metrics& metrics = *comparison.metrics;
    for (const MetricInfo& metric : all_metrics()) {
        const auto value = metric.value(metrics);
        if (!value && metric.is_on_request) continue;
        std::printf("%-14s %12s   %s\n", std::string(metric.name).c_str(),
                    value_text(value).c_str(), std::string(metric.formula).c_str());
    }
    if (metrics.identical_8bit) std::printf("the 8-bit images are identical\n");
    for (const MetricInfo& metric : all_metrics()) {
        if (!metric.reason || metric.reason(metrics).empty()) continue;
        std::printf("no %s: %s\n", std::string(metric.name).c_str(),
                    metric.reason(metrics).c_str());
    }
    if (comparison.regions) print_regions(*comparison.regions);
}

/// What is known of the reference's own error, and whether it is what the comparison shows.
nlohmann::json reference_facts(const Frame& reference, const RegionMap* regions,
                               const Comparison& comparison) {
    const nlohmann::json error = reference_error(reference, regions);
    const auto flag = limited_by_reference(metrics_json(comparison.metrics), error);
    return {{"reference_error", error},
            {"limited_by_reference", flag ? nlohmann::json(*flag) : nlohmann::json()}};
}

void print_reference(const nlohmann::json& facts) {
    const nlohmann::json& error = facts["reference_error"];
    if (!error.is_object()) {
        std::printf("reference's own error: unknown, the file has no Variance planes\n");
        return;
    }
    std::printf("reference's own error: psnr_float_db %s, relmse %s, from its Variance planes\n",
                number_of(error["psnr_float_db"], 5).c_str(),
                number_of(error["relmse"], 5).c_str());
    if (facts["limited_by_reference"] == true)
        std::printf("%s\n", std::string(kLimitedFormula).c_str());
}

/// Says on stderr which limit failed; true if all hold.
bool limits_hold(const CompareArguments& arguments, const Metrics& m) {
    bool hold = true;
    const auto fail = [&](const char* metric, const std::string& found, const std::string& limit) {
        std::fprintf(stderr, "failed: %s is %s, limit %s\n", metric, found.c_str(), limit.c_str());
        hold = false;
    };
    if (arguments.min_psnr && m.psnr_db && *m.psnr_db < *arguments.min_psnr) {
        fail("psnr_db", number_text(*m.psnr_db, 4), ">= " + number_text(*arguments.min_psnr, 4));
    }
    if (arguments.min_ssim && !m.ssim) fail("ssim", m.ssim_reason, "a value");
    if (arguments.min_ssim && m.ssim && *m.ssim < *arguments.min_ssim) {
        fail("ssim", number_text(*m.ssim, 6), ">= " + number_text(*arguments.min_ssim, 6));
    }
    if (arguments.max_relmse && m.relmse > *arguments.max_relmse) {
        fail("relmse", number_text(m.relmse, 8), "<= " + number_text(*arguments.max_relmse, 8));
    }
    return hold;
}

struct Reference {
    Frame frame;             ///< with the planes that regions are made from, if it has them
    std::string no_regions;  ///< why its planes could not be read
};

Reference load_reference(const std::string& path) {
    try {
        return {load_frame(path), ""};
    } catch (const Error& error) {
        // Other programs' planes may not be what ours are, and comparing needs radiance alone.
        Reference reference{{}, error.what()};
        reference.frame.radiance = load_image(path);
        return reference;
    }
}

/// What can be said before the work: a job that cannot end well does not start.
void require_files(const CompareArguments& arguments) {
    require_map_extension(arguments.error_map);
    require_readable(arguments.test);
    require_readable(arguments.reference);
    if (!arguments.error_map.empty()) require_writable(arguments.error_map);
}

void print_comparison(const CompareArguments& arguments, const Comparison& comparison,
                      const nlohmann::json& facts) {
    if (arguments.json) {
        nlohmann::json json = comparison_json(comparison);
        json.update(facts);
        std::printf("%s\n", json.dump().c_str());
        return;
    }
    print_metrics(comparison);
    if (comparison.metrics) print_reference(facts);
}

std::optional<RegionMap> regions_in(const Frame& reference) {
    if (!has_region_planes(reference)) return std::nullopt;
    return regions_of(reference);
}

ExitCode run_compare(const CompareArguments& arguments) {
    require_files(arguments);
    const Image test = load_image(arguments.test);
    const Reference loaded = load_reference(arguments.reference);
    const Image& reference = loaded.frame.radiance;
    if (test.size() != reference.size()) {
        throw Error(ExitCode::mismatch, size_mismatch_text(arguments.test, test.size(),
                                                           arguments.reference, reference.size()));
    }
    const std::optional<RegionMap> regions = regions_in(loaded.frame);
    const RegionMap* const map = regions ? &*regions : nullptr;
    const Comparison comparison = compare(test, reference, map, arguments.metrics);
    write_error_map(arguments, test, reference);
    print_comparison(arguments, comparison, reference_facts(loaded.frame, map, comparison));
    if (!comparison.metrics) {
        std::fprintf(stderr, "error: %s\n",
                     non_finite_text(arguments, comparison.non_finite).c_str());
        return ExitCode::non_finite;
    }
    if (!loaded.no_regions.empty())
        std::fprintf(stderr, "warning: no regions: %s\n", loaded.no_regions.c_str());
    return limits_hold(arguments, *comparison.metrics) ? ExitCode::ok : ExitCode::quality;
}

/// A limit that is not a number would let everything pass.
CLI::Validator finite_number() {
    const auto check = [](const std::string& text) -> std::string {
        const auto value = option_value(text);
        const bool is_finite = value.is_number() && std::isfinite(value.get<double>());
        return is_finite ? "" : "found \"" + text + "\", allowed: a finite number";
    };
    return {check, ""};
}

std::string regions_help() {
    std::string text = "Regions, the first that fits:";
    for (const RegionInfo& info : kRegions)
        text += "\n  " + std::string(info.name) + ": " + std::string(info.definition);
    return text;
}

}  // namespace

void add_compare_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<CompareArguments>();
    CLI::App* const command =
        app.add_subcommand("compare", "measure how far an image is from its reference");
    command->footer(regions_help());
    command->add_option("TEST", arguments->test, "image")->required();
    command
        ->add_option("REFERENCE", arguments->reference,
                     "image of the same size; an .exr with the planes emission, albedo, normal and "
                     "id gives metrics per region, too")
        ->required();
    command
        ->add_option("--error-map", arguments->error_map,
                     ".png: a picture with a scale; .exr: test - reference, linear")
        ->check(not_empty());
    command
        ->add_option("--error-kind", arguments->error_kind,
                     "what the picture shows: magnitude, sign")
        ->check(CLI::IsMember({"magnitude", "sign"}));
    const auto add_limit = [command](const char* flag, std::optional<double>& limit,
                                     const char* summary) {
        command->add_option(flag, limit, summary)->check(finite_number());
    };
    add_limit("--min-psnr", arguments->min_psnr, "fail below this psnr_db");
    add_limit("--min-ssim", arguments->min_ssim, "fail below this ssim");
    add_limit("--max-relmse", arguments->max_relmse, "fail above this relmse");
    command
        ->add_option("--metric", arguments->metrics,
                     "measure this one, too, which costs more than the others")
        ->check(CLI::IsMember(metrics_on_request()))
        ->allow_extra_args(false);
    command->add_flag("--json", arguments->json, "print one JSON object");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_compare(*arguments); }; });
}

}  // namespace vecino
