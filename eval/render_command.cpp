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
#include "eval/method_maps.h"
#include "eval/part_metadata.h"
#include "eval/progress.h"
#include "eval/render_metadata.h"
#include "eval/render_options.h"
#include "filters/methods.h"

namespace vecino {
namespace {

struct RenderArguments {
    std::string scene;
    std::string output;
    std::map<std::string, std::string> options;  ///< by matrix key, as given
    std::string method = "path";
    std::map<std::string, std::string> method_options;  ///< likewise
    std::string planes;
    std::string maps;     ///< file of the method's maps, or empty
    std::string samples;  ///< A:B, or empty
    int threads = 0;
    int simd_width = 0;
    bool json = false;
};

bool is_exr(const std::string& path) {
    return std::filesystem::path(path).extension() == ".exr";
}

/// Sets what was given on the command line.
template <class Parameters>
void set_given(std::span<const OptionRow<Parameters>> rows,
               const std::map<std::string, std::string>& texts, Parameters& parameters) {
    for (const OptionRow<Parameters>& row : rows) {
        const auto given = texts.find(std::string(row.name));
        if (given == texts.end() || given->second.empty()) continue;
        const nlohmann::json value = option_value(given->second);
        row.set(parameters, JsonValue(value, "command line", std::string(row.flag)));
    }
}

MethodParameters method_parameters_of(const RenderArguments& arguments) {
    MethodParameters parameters;
    set_given(method_options(), arguments.method_options, parameters);
    return parameters;
}

/// An option that the method does not read would be given in vain.
void require_read_options(const RenderArguments& arguments, const Method& method) {
    for (const MethodOption& row : method_options()) {
        const auto given = arguments.method_options.find(std::string(row.name));
        const bool is_given = given != arguments.method_options.end() && !given->second.empty();
        if (!is_given || method.reads(row.name)) continue;
        std::string readers;
        for (const Method& other : all_methods()) {
            if (other.reads(row.name))
                readers += (readers.empty() ? "" : ", ") + std::string(other.name);
        }
        throw Error(ExitCode::usage, "command line: " + std::string(row.flag) +
                                         ": found with --method " + std::string(method.name) +
                                         ", allowed: with " + readers);
    }
}

RenderSettings settings_of(const RenderArguments& arguments) {
    RenderSettings settings;
    set_given(render_options(), arguments.options, settings);
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

void print_result(const RenderArguments& arguments, const MethodRender& result,
                  const std::string& what, double write_s) {
    const RenderStatistics& s = result.render.statistics;
    if (arguments.json) {
        std::printf("%s\n", render_json(result, write_s).dump().c_str());
        return;
    }
    std::printf("%s: %s, %.2f s, %.2f Msamples/s on %d threads\n", arguments.output.c_str(),
                what.c_str(), s.scene_s + s.trace_s + result.reconstruct_s + write_s,
                s.trace_s > 0 ? static_cast<double>(s.samples) / s.trace_s * 1e-6 : 0.0, s.threads);
}

/// Traces with a progress bar.
template <class Trace>
auto with_progress(const Scene& scene, const Trace& trace) {
    catch_interrupts();
    ProgressBar bar("render " + scene.name);
    return trace([&](double done) { return bar.update(done); });
}

/// The maps go into a file of their own; of these, the frame keeps what it was asked for.
void save_maps(const RenderArguments& arguments, Planes asked, MethodRender& result) {
    if (arguments.maps.empty()) return;
    Frame& frame = result.render.frame;
    save_method_maps(frame.sample_count, result, arguments.maps);
    if (!asked.has(Plane::count)) frame.sample_count = {};
}

ExitCode render_image(const RenderArguments& arguments, const RenderSettings& settings,
                      const Scene& scene) {
    const Method& method = find_method(arguments.method);
    MethodRequest request{scene, settings, method_parameters_of(arguments)};
    if (!arguments.maps.empty()) request.settings.planes.add(Plane::count);
    MethodRender result = with_progress(
        scene, [&](const Progress& progress) { return render(method, request, progress); });
    save_maps(arguments, settings.planes, result);
    const RenderStatistics& s = result.render.statistics;
    const Frame& frame = result.render.frame;
    Metadata metadata =
        render_metadata(arguments.scene, settings, s.scene_s + s.trace_s + result.reconstruct_s);
    describe_method(method, request.parameters, metadata);
    const Stopwatch write_watch;
    describe_schedule(result, metadata);
    report_schedule(result);
    save_frame(frame, arguments.output, metadata);
    print_result(arguments, result, size_text(frame.size()), write_watch.seconds());
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
    print_result(arguments, {.render = {{}, s}},
                 size_text(result.part.sums.size()) + ", samples " + interval_text(samples) +
                     " of " + std::to_string(settings.spp),
                 write_watch.seconds());
    return report_non_finite(s, arguments.output);
}

ExitCode run_render(const RenderArguments& arguments) {
    require_writable_extension(arguments.output);
    const RenderSettings settings = settings_of(arguments);
    const Method& method = find_method(arguments.method);
    require_read_options(arguments, method);
    (void)method_parameters_of(arguments);  // before the scene is read
    const bool in_part = !arguments.samples.empty();
    if (!arguments.maps.empty()) require_map_extension(arguments.maps);
    if (in_part) {
        interval_of(arguments.samples, settings.spp);  // before the scene is read
        if (!arguments.maps.empty())
            throw Error(ExitCode::usage,
                        "command line: --maps: found with --samples, allowed: without");
        if (!is_exr(arguments.output)) {
            throw Error(ExitCode::usage, arguments.output +
                                             ": found another extension, allowed with --samples: "
                                             ".exr");
        }
        if (&method != &all_methods().front()) {
            throw Error(ExitCode::usage, "command line: --method: found \"" + arguments.method +
                                             "\", allowed with --samples: " +
                                             std::string(all_methods().front().name));
        }
    }
    const Scene scene = load_scene(arguments.scene);
    require_writable(arguments.output);
    if (!arguments.maps.empty()) require_writable(arguments.maps);
    return in_part ? render_samples(arguments, settings, scene)
                   : render_image(arguments, settings, scene);
}

std::string method_names() {
    std::vector<std::string_view> names;
    for (const Method& method : all_methods()) names.push_back(method.name);
    return join(names);
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
    command->add_option("--method", arguments->method, method_names());
    for (const MethodOption& row : method_options()) {
        add_table_option(*command, row, arguments->method_options[std::string(row.name)]);
    }
    command
        ->add_option(
            "--planes", arguments->planes,
            "all, or a list such as radiance,normal,id; all leaves out albedo_mean and normal_mean")
        ->check(not_empty());
    command
        ->add_option("--maps", arguments->maps,
                     "write what the method did where, samples per pixel first (.exr: channels; "
                     ".png, .bmp: pictures side by side)")
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
