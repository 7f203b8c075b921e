// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "core/files.h"
#include "core/image_io.h"
#include "core/part_file.h"
#include "core/render.h"
#include "core/timing.h"
#include "eval/cell_sources.h"
#include "eval/commands.h"
#include "eval/part_metadata.h"
#include "eval/progress.h"
#include "eval/render_metadata.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

struct RenderArguments {
    std::string scene;
    std::string output;
    std::map<std::string, std::string> options;  ///< by matrix key, as given
    std::string planes;
    std::string samples;  ///< A:B, or empty
    int threads = 0;
    int simd_width = 0;
    bool json = false;
};

bool is_exr(const std::string& path) {
    return std::filesystem::path(path).extension() == ".exr";
}

RenderSettings settings_of(const RenderArguments& arguments) {
    RenderSettings settings;
    for (const RenderOption& row : render_options()) {
        const auto given = arguments.options.find(std::string(row.name));
        if (given == arguments.options.end() || given->second.empty()) continue;
        const nlohmann::json value = option_value(given->second);
        row.set(settings, JsonValue(value, "command line", std::string(row.flag)));
    }
    settings.threads = arguments.threads;
    settings.simd_width = arguments.simd_width;
    settings.planes = is_exr(arguments.output) ? Planes::all() : Planes{Plane::radiance};
    if (!arguments.planes.empty()) settings.planes = parse_planes(arguments.planes);
    return settings;
}

SampleInterval interval_of(const std::string& text, int spp) {
    const auto fail = [&](const std::string& fault) {
        throw Error(ExitCode::usage, "command line: --samples: " + fault);
    };
    const char* const end = text.data() + text.size();
    SampleInterval samples;
    const auto first = std::from_chars(text.data(), end, samples.begin);
    const bool colon = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
    const auto second = std::from_chars(colon ? first.ptr + 1 : end, end, samples.end);
    if (!colon || second.ec != std::errc() || second.ptr != end) {
        fail("found \"" + text + "\", allowed: A:B, two integers");
    }
    const std::string fault = interval_fault(samples, spp);
    if (!fault.empty()) fail(fault);
    return samples;
}

void print_result(const RenderArguments& arguments, const RenderStatistics& s,
                  const std::string& what, double write_s) {
    if (arguments.json) {
        std::printf("%s\n", render_json(s, write_s).dump().c_str());
        return;
    }
    std::printf("%s: %s, %.2f s, %.2f Msamples/s on %d threads\n", arguments.output.c_str(),
                what.c_str(), s.scene_s + s.trace_s + write_s,
                s.trace_s > 0 ? static_cast<double>(s.samples) / s.trace_s * 1e-6 : 0.0, s.threads);
}

/// Traces with a progress bar.
template <class Trace>
auto with_progress(const Scene& scene, const Trace& trace) {
    catch_interrupts();
    ProgressBar bar("render " + scene.name);
    return trace([&](double done) { return bar.update(done); });
}

ExitCode render_image(const RenderArguments& arguments, const RenderSettings& settings,
                      const Scene& scene) {
    const Render result = with_progress(
        scene, [&](const Progress& progress) { return render(scene, settings, progress); });
    const RenderStatistics& s = result.statistics;
    const Stopwatch write_watch;
    save_frame(result.frame, arguments.output,
               render_metadata(arguments.scene, settings, s.scene_s + s.trace_s));
    print_result(arguments, s, size_text(result.frame.size()), write_watch.seconds());
    return report_non_finite(s, arguments.output);
}

ExitCode render_samples(const RenderArguments& arguments, const RenderSettings& settings,
                        const Scene& scene) {
    const SampleInterval samples = interval_of(arguments.samples, settings.spp);
    const std::string hash = scene_hash(arguments.scene, scene);
    const PartRender result = with_progress(scene, [&](const Progress& progress) {
        return render_part(scene, settings, samples, progress);
    });
    const RenderStatistics& s = result.statistics;
    Metadata metadata = render_metadata(arguments.scene, settings, s.scene_s + s.trace_s);
    describe_part(hash, s, metadata);
    const Stopwatch write_watch;
    save_part(result.part, arguments.output, metadata);
    print_result(arguments, s,
                 size_text(result.part.sums.size()) + ", samples " + interval_text(samples) +
                     " of " + std::to_string(settings.spp),
                 write_watch.seconds());
    return report_non_finite(s, arguments.output);
}

ExitCode run_render(const RenderArguments& arguments) {
    require_writable_extension(arguments.output);
    const RenderSettings settings = settings_of(arguments);
    const bool in_part = !arguments.samples.empty();
    if (in_part) {
        interval_of(arguments.samples, settings.spp);  // before the scene is read
        if (!is_exr(arguments.output)) {
            throw Error(ExitCode::usage, arguments.output +
                                             ": found another extension, allowed with --samples: "
                                             ".exr");
        }
    }
    const Scene scene = load_scene(arguments.scene);
    require_writable(arguments.output);
    return in_part ? render_samples(arguments, settings, scene)
                   : render_image(arguments, settings, scene);
}

}  // namespace

void add_render_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* const command = app.add_subcommand("render", "trace a scene");
    command->add_option("SCENE", arguments->scene, "scene file (JSON)")->required();
    command->add_option("-o", arguments->output, "image to write: " + writable_extensions())
        ->required();
    for (const RenderOption& row : render_options()) {
        add_table_option(*command, row, arguments->options[std::string(row.name)]);
    }
    command->add_option("--planes", arguments->planes, "all, or a list such as radiance,normal,id")
        ->check(not_empty());
    command
        ->add_option("--samples", arguments->samples,
                     "trace samples A to B - 1 alone, into a part for vecino merge "
                     "(A:B, multiples of 64; B may be spp)")
        ->check(not_empty());
    command->add_option("--threads", arguments->threads, "default: all")
        ->check(CLI::Range(1, 1024));
    command->add_option("--simd-width", arguments->simd_width, "samples side by side: 1, 4, 8, 16")
        ->check(CLI::IsMember({1, 4, 8, 16}));
    command->add_flag("--json", arguments->json, "print times and counts as JSON");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_render(*arguments); }; });
}

}  // namespace vecino
