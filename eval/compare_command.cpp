// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/image_io.h"
#include "eval/commands.h"
#include "eval/error_map.h"
#include "eval/metrics.h"
#include "eval/metrics_json.h"

namespace vecino {
namespace {

struct CompareArguments {
    std::string test;
    std::string reference;
    std::string error_map;
    std::string error_kind = "magnitude";
    std::optional<double> min_psnr, min_ssim, max_relmse;
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

void print_metrics(const Comparison& comparison) {
    if (!comparison.metrics) return;
    for (const MetricInfo& metric : all_metrics()) {
        const auto value = metric.value(*comparison.metrics);
        const std::string name(metric.name);
        const std::string formula(metric.formula);
        std::printf("%-14s %12s   %s\n", name.c_str(), value ? number_text(*value, 5).c_str() : "-",
                    formula.c_str());
    }
    if (comparison.metrics->identical_8bit) std::printf("the 8-bit images are identical\n");
    if (!comparison.metrics->ssim_reason.empty()) {
        std::printf("no ssim: %s\n", comparison.metrics->ssim_reason.c_str());
    }
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

ExitCode run_compare(const CompareArguments& arguments) {
    require_map_extension(arguments.error_map);
    const Image test = load_image(arguments.test);
    const Image reference = load_image(arguments.reference);
    if (test.size() != reference.size()) {
        throw Error(ExitCode::mismatch, size_mismatch_text(arguments.test, test.size(),
                                                           arguments.reference, reference.size()));
    }
    const Comparison comparison = compare(test, reference);
    write_error_map(arguments, test, reference);
    if (arguments.json) {
        std::printf("%s\n", comparison_json(comparison).dump().c_str());
    } else {
        print_metrics(comparison);
    }
    if (!comparison.metrics) {
        std::fprintf(stderr, "error: %s\n",
                     non_finite_text(arguments, comparison.non_finite).c_str());
        return ExitCode::non_finite;
    }
    return limits_hold(arguments, *comparison.metrics) ? ExitCode::ok : ExitCode::quality;
}

}  // namespace

void add_compare_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<CompareArguments>();
    CLI::App* const command =
        app.add_subcommand("compare", "measure how far an image is from its reference");
    command->add_option("TEST", arguments->test, "image")->required();
    command->add_option("REFERENCE", arguments->reference, "image of the same size")->required();
    command->add_option("--error-map", arguments->error_map,
                        ".png: a picture with a scale; .exr: test - reference, linear");
    command
        ->add_option("--error-kind", arguments->error_kind,
                     "what the picture shows: magnitude, sign")
        ->check(CLI::IsMember({"magnitude", "sign"}));
    command->add_option("--min-psnr", arguments->min_psnr, "fail below this psnr_db");
    command->add_option("--min-ssim", arguments->min_ssim, "fail below this ssim");
    command->add_option("--max-relmse", arguments->max_relmse, "fail above this relmse");
    command->add_flag("--json", arguments->json, "print one JSON object");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_compare(*arguments); }; });
}

}  // namespace vecino
