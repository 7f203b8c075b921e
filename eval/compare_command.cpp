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
#include "eval/comparison_vti.h"
#include "eval/error_map.h"
#include "eval/gate_report.h"
#include "eval/image_series.h"
#include "eval/loaded_frame.h"
#include "eval/metrics.h"
#include "eval/metrics_json.h"
#include "eval/reference_error.h"
#include "eval/render_options.h"
#include "eval/unbiased_compare.h"

namespace vecino {
namespace {

struct CompareArguments {
    std::string test;
    std::string reference;
    std::string error_map;
    std::string error_kind = "magnitude";
    std::vector<std::string> channels, reference_channels;  ///< empty: R, G, B or Y
    std::string test_kind;
    std::string ctest;
    bool series = false;
    std::optional<double> min_psnr, min_ssim, max_relmse;
    std::vector<std::string> metrics;
    bool json = false;
};

void require_map_extension(const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    if (path.empty() || extension == ".png" || extension == ".exr" || extension == ".vti") return;
    throw Error(ExitCode::usage, "--error-map: found \"" + path +
                                     "\", allowed: a name that ends in .png, .exr or .vti");
}

void write_error_vti(const CompareArguments& arguments, ComparedFrames compared,
                     const Comparison& comparison) {
    if (std::filesystem::path(arguments.error_map).extension() != ".vti") return;
    compared.metrics = comparison_json(comparison);
    save_comparison_vti(compared, arguments.error_map);
}

void write_error_map(const CompareArguments& arguments, const Image& test, const Image& reference) {
    const std::string& path = arguments.error_map;
    if (path.empty() || std::filesystem::path(path).extension() == ".vti") return;
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

/// What CTest hands on to a dashboard: every metric, and pictures.
void print_measurements(const CompareArguments& arguments, const Image& test,
                        const Image& reference, const Metrics& metrics) {
    if (arguments.ctest.empty()) return;
    std::string tags;
    for (const MetricInfo& metric : all_metrics()) {
        if (const auto value = metric.value(metrics))
            tags += ctest_number(std::string(metric.name), *value);
    }
    tags += write_comparison(test, reference, arguments.ctest);
    std::printf("%s", tags.c_str());
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

/// Whose channels are named has no planes of ours.
LoadedFrame load_with(const std::string& path, const std::vector<std::string>& channels,
                      bool wants_planes) {
    if (channels.empty()) return wants_planes ? load_planes(path) : load_radiance(path);
    LoadedFrame loaded;
    loaded.frame.radiance = load_image(path, {channels[0], channels[1], channels[2]});
    return loaded;
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

ExitCode run_compare(const CompareArguments& given) {
    CompareArguments arguments = given;
    if (arguments.series) arguments.reference = best_valid_image(given.test, given.reference);
    require_files(arguments);
    const bool wants_planes = std::filesystem::path(arguments.error_map).extension() == ".vti";
    const LoadedFrame tested = load_with(arguments.test, arguments.channels, wants_planes);
    const Image& test = tested.frame.radiance;
    const LoadedFrame loaded = load_with(arguments.reference, arguments.reference_channels, true);
    const Image& reference = loaded.frame.radiance;
    if (test.size() != reference.size()) {
        throw Error(ExitCode::mismatch, size_mismatch_text(arguments.test, test.size(),
                                                           arguments.reference, reference.size()));
    }
    const std::optional<RegionMap> regions = regions_in(loaded.frame);
    const RegionMap* const map = regions ? &*regions : nullptr;
    const Comparison comparison = compare(test, reference, map, arguments.metrics);
    write_error_map(arguments, test, reference);
    write_error_vti(arguments, {tested.frame, loaded.frame, map, {}}, comparison);
    const bool tests = arguments.test_kind == "unbiased" && comparison.metrics;
    std::vector<UnbiasedRule> rules;
    if (tests) rules = compare_unbiased(arguments.test, arguments.reference);
    nlohmann::json facts = reference_facts(loaded.frame, map, comparison);
    if (tests) facts["unbiased"] = unbiased_json(rules);
    print_comparison(arguments, comparison, facts);
    if (!arguments.json) std::printf("%s", unbiased_text(rules).c_str());
    if (!comparison.metrics) {
        std::fprintf(stderr, "error: %s\n",
                     non_finite_text(arguments, comparison.non_finite).c_str());
        return ExitCode::non_finite;
    }
    print_measurements(arguments, test, reference, *comparison.metrics);
    if (!loaded.no_planes.empty())
        std::fprintf(stderr, "warning: no regions: %s\n", loaded.no_planes.c_str());
    const bool same_expectation = std::ranges::all_of(rules, &UnbiasedRule::holds);
    const bool hold = limits_hold(arguments, *comparison.metrics) && same_expectation;
    return hold ? ExitCode::ok : ExitCode::quality;
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
                     ".png: a picture with a scale; .exr: test - reference, linear; .vti: every "
                     "array, for ParaView")
        ->check(not_empty());
    command
        ->add_option("--error-kind", arguments->error_kind,
                     "what the picture shows: magnitude, sign")
        ->check(CLI::IsMember({"magnitude", "sign"}));
    const auto add_channels = [command](const char* flag, std::vector<std::string>& names,
                                        const char* summary) {
        command->add_option(flag, names, summary)->delimiter(',')->expected(3);
    };
    add_channels("--channels", arguments->channels,
                 "the test's channels of red, green and blue, as R,G,B");
    add_channels("--reference-channels", arguments->reference_channels, "the reference's");
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
    command
        ->add_option("--test", arguments->test_kind,
                     "unbiased: fail unless both may be of the same expected image; both need the "
                     "planes variance and count")
        ->check(CLI::IsMember({"unbiased"}));
    CLI::Option* const json = command->add_flag("--json", arguments->json, "print one JSON object");
    command->add_flag(
        "--series", arguments->series,
        "REFERENCE may have alternatives, as ref_1.exr, ref_2.exr beside ref.exr: the "
        "best match counts");
    command
        ->add_option("--ctest", arguments->ctest,
                     "a folder for test.png, valid.png and difference.png; also print measurements "
                     "and images as CTest hands them to CDash")
        ->check(not_empty())
        ->excludes(json);
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_compare(*arguments); }; });
}

}  // namespace vecino
