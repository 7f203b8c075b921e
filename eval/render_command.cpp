// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "core/files.h"
#include "core/image_io.h"
#include "core/render.h"
#include "core/timing.h"
#include "eval/commands.h"
#include "eval/progress.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

struct RenderArguments {
    std::string scene;
    std::string output;
    std::map<std::string, std::string> options;  ///< by matrix key, as given
    std::string planes;
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

Metadata metadata_of(const std::string& scene, const RenderSettings& s, double seconds) {
    Metadata metadata{
        {"scene", scene}, {"version", VECINO_VERSION}, {"seconds", static_cast<float>(seconds)}};
    for (const RenderOption& row : render_options()) {
        const nlohmann::json value = row.get(s);
        const std::string key = row.name == "max_depth" ? "depth" : std::string(row.name);
        if (value.is_number_integer() || value.is_number_unsigned()) {
            metadata[key] = value.get<int>();
        } else {
            metadata[key] = value.is_string() ? value.get<std::string>() : value.dump();
        }
    }
    return metadata;
}

nlohmann::json result_json(const RenderStatistics& s, double write_s) {
    return {{"time_s",
             {{"total", s.scene_s + s.trace_s + write_s},
              {"scene", s.scene_s},
              {"trace", s.trace_s},
              {"reconstruct", 0.0},
              {"write", write_s}}},
            {"samples", s.samples},
            {"rays", s.rays},
            {"samples_per_s", s.trace_s > 0 ? static_cast<double>(s.samples) / s.trace_s : 0.0},
            {"threads", s.threads},
            {"simd_width", s.simd_width},
            {"dropped_samples", s.dropped_samples},
            {"non_finite_pixels", s.non_finite_pixels}};
}

void print_result(const RenderArguments& arguments, const Render& result, double write_s) {
    if (arguments.json) {
        std::printf("%s\n", result_json(result.statistics, write_s).dump().c_str());
        return;
    }
    const RenderStatistics& s = result.statistics;
    const Extent size = result.frame.size();
    std::printf("%s: %dx%d, %.2f s, %.2f Msamples/s on %d threads\n", arguments.output.c_str(),
                size.width, size.height, s.scene_s + s.trace_s + write_s,
                s.trace_s > 0 ? static_cast<double>(s.samples) / s.trace_s * 1e-6 : 0.0, s.threads);
}

ExitCode run_render(const RenderArguments& arguments) {
    require_writable_extension(arguments.output);
    const RenderSettings settings = settings_of(arguments);
    const Scene scene = load_scene(arguments.scene);
    require_writable(arguments.output);
    catch_interrupts();
    const Render result = [&] {
        ProgressBar bar("render " + scene.name);
        return render(scene, settings, [&](double done) { return bar.update(done); });
    }();
    const RenderStatistics& s = result.statistics;
    const Stopwatch write_watch;
    save_frame(result.frame, arguments.output,
               metadata_of(arguments.scene, settings, s.scene_s + s.trace_s));
    print_result(arguments, result, write_watch.seconds());
    if (s.non_finite_pixels > 0) {
        std::fprintf(stderr, "error: %s: %llu pixels are not finite\n", arguments.output.c_str(),
                     static_cast<unsigned long long>(s.non_finite_pixels));
        return ExitCode::non_finite;
    }
    if (s.dropped_samples > 0) {
        std::fprintf(stderr, "warning: %llu samples were not finite and were left out\n",
                     static_cast<unsigned long long>(s.dropped_samples));
    }
    return ExitCode::ok;
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
    command->add_option("--threads", arguments->threads, "default: all")
        ->check(CLI::Range(1, 1024));
    command->add_option("--simd-width", arguments->simd_width, "samples side by side: 1, 4, 8, 16")
        ->check(CLI::IsMember({1, 4, 8, 16}));
    command->add_flag("--json", arguments->json, "print times and counts as JSON");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_render(*arguments); }; });
}

}  // namespace vecino
