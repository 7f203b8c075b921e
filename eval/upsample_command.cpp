// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <map>
#include <memory>

#include "core/files.h"
#include "core/image_io.h"
#include "core/renderer_channels.h"
#include "core/timing.h"
#include "eval/commands.h"
#include "eval/render_options.h"
#include "filters/guide.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

struct UpsampleArguments {
    std::string input;
    std::string output;
    std::string size;
    std::string scheme;
    std::string guide;                           ///< file; or empty
    std::vector<std::string> channels;           ///< PLANE=X,Y,Z
    std::map<std::string, std::string> options;  ///< by matrix key, as given
    bool no_centre = false;
    int threads = 0;
    bool json = false;
};

Extent size_of(const std::string& text) {
    RenderSettings settings;
    const nlohmann::json value = option_value(text);
    for (const RenderOption& row : render_options()) {
        if (row.name == "size") row.set(settings, JsonValue(value, "command line", "--size"));
    }
    return settings.size;
}

SchemeParameters parameters_of(const UpsampleArguments& arguments, const Scheme& scheme) {
    SchemeParameters parameters = scheme.defaults;
    for (const SchemeOption& row : scheme_options()) {
        const auto given = arguments.options.find(std::string(row.name));
        if (given == arguments.options.end() || given->second.empty()) continue;
        const nlohmann::json value = option_value(given->second);
        row.set(parameters, JsonValue(value, "command line", std::string(row.flag)));
    }
    parameters.use_centre = !arguments.no_centre;
    return parameters;
}

/// Options that were given in vain.
void print_notes(const UpsampleArguments& arguments, const Scheme& scheme) {
    for (const SchemeOption& row : scheme_options()) {
        const auto given = arguments.options.find(std::string(row.name));
        if (given == arguments.options.end() || given->second.empty()) continue;
        if (scheme.reads(row.name)) continue;
        std::fprintf(stderr, "note: %s does not read %s\n", arguments.scheme.c_str(),
                     std::string(row.flag).c_str());
    }
    if (!arguments.guide.empty() && !scheme.uses_guide())
        std::fprintf(stderr, "note: %s does not read --guide\n", arguments.scheme.c_str());
}

ChannelNames channel_names_of(const UpsampleArguments& arguments) {
    ChannelNames names;
    for (const std::string& text : arguments.channels) add_channel_names(text, names);
    return names;
}

void note_half_positions(const RendererFrame& file, const std::string& path) {
    if (file.half_planes.has(Plane::position))
        std::fprintf(stderr, "note: %s: positions are 16-bit numbers, coarse ones: write 32 bits\n",
                     path.c_str());
}

/// With the planes that the scheme needs. Of a plane that it may do without, the names that were
/// given are those of the guide where this file has none such.
Frame load_low(const UpsampleArguments& arguments, const Scheme& scheme) {
    Planes wanted{Plane::radiance};
    wanted.add(scheme.needs);
    if (scheme.needs.has(Plane::position)) wanted.add(Plane::id);
    ChannelNames names = channel_names_of(arguments);
    std::erase_if(names, [&](const auto& entry) { return !wanted.has(entry.first); });
    RendererFrame low = load_renderer_frame(arguments.input, wanted, names);
    note_half_positions(low, arguments.input);
    try {
        const Frame more =
            load_renderer_frame(arguments.input, scheme.may_read, channel_names_of(arguments))
                .frame;
        if (scheme.may_read.has(Plane::emission)) low.frame.emission = more.emission;
    } catch (const Error& error) {
        if (error.code() != ExitCode::mismatch) throw;
    }
    return std::move(low.frame);
}

Frame load_guide(const UpsampleArguments& arguments, const Scheme& scheme) {
    RendererFrame file =
        load_renderer_frame(arguments.guide, scheme.guide_reads, channel_names_of(arguments));
    note_half_positions(file, arguments.guide);
    require_guide(file.frame, size_of(arguments.size), arguments.guide);
    for (const std::string& note : check_guide(file.frame, arguments.guide))
        std::fprintf(stderr, "note: %s\n", note.c_str());
    return std::move(file.frame);
}

void require_guide_flag(const UpsampleArguments& arguments, const Scheme& scheme) {
    if (scheme.uses_guide() && arguments.guide.empty())
        throw Error(ExitCode::usage, "command line: --scheme " + arguments.scheme +
                                         ": found no --guide, allowed: with a file of "
                                         "full-resolution planes");
}

struct Times {
    double read_s, reconstruct_s, write_s;
};

nlohmann::json result_json(const Reconstruction& result, const Times& t) {
    return {{"time_s",
             {{"total", t.read_s + t.reconstruct_s + t.write_s},
              {"read", t.read_s},
              {"reconstruct", t.reconstruct_s},
              {"write", t.write_s}}},
            {"fallback_pixels", result.fallback_pixels},
            {"dropped_samples", result.dropped_samples},
            {"non_finite_pixels", result.non_finite_pixels},
            {"fits_of_order", result.fits_of_order}};
}

ExitCode report(const UpsampleArguments& arguments, const Reconstruction& result,
                const Times& times) {
    if (arguments.json) {
        std::printf("%s\n", result_json(result, times).dump().c_str());
    } else {
        std::printf("%s: %s, %s, %.2f ms, %zu fallback pixels\n", arguments.output.c_str(),
                    arguments.size.c_str(), arguments.scheme.c_str(), 1e3 * times.reconstruct_s,
                    result.fallback_pixels);
    }
    if (result.non_finite_pixels > 0) {
        std::fprintf(stderr, "error: %s: nothing finite for %zu low-res pixels, they are 0\n",
                     arguments.output.c_str(), result.non_finite_pixels);
        return ExitCode::non_finite;
    }
    if (result.dropped_samples > 0) {
        std::fprintf(stderr, "warning: %s: %zu low-res pixels are not finite and were left out\n",
                     arguments.input.c_str(), result.dropped_samples);
    }
    return ExitCode::ok;
}

ExitCode run_upsample(const UpsampleArguments& arguments) {
    require_writable_extension(arguments.output);
    const Scheme& scheme = find_scheme(arguments.scheme);
    ReconstructionRequest request{size_of(arguments.size), parameters_of(arguments, scheme),
                                  arguments.threads};
    require_guide_flag(arguments, scheme);
    require_writable(arguments.output);
    const Stopwatch read_watch;
    const Frame low = load_low(arguments, scheme);
    require_planes(scheme, low, arguments.input);
    Frame guide;
    if (scheme.uses_guide()) {
        guide = load_guide(arguments, scheme);
        request.guide = &guide;
    }
    const double read_s = read_watch.seconds();
    const Stopwatch reconstruct_watch;
    const Reconstruction result = reconstruct(low, scheme, request);
    const double reconstruct_s = reconstruct_watch.seconds();
    const Stopwatch write_watch;
    save_image(result.image, arguments.output);
    print_notes(arguments, scheme);
    return report(arguments, result, {read_s, reconstruct_s, write_watch.seconds()});
}

std::string scheme_names() {
    std::vector<std::string_view> names;
    for (const Scheme& scheme : all_schemes()) names.push_back(scheme.name);
    return join(names);
}

}  // namespace

void add_upsample_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<UpsampleArguments>();
    CLI::App* const command =
        app.add_subcommand("upsample", "rebuild a large image from a small one");
    command->add_option("LOW", arguments->input, "low-resolution frame")->required();
    command->add_option("-o", arguments->output, "image to write: " + writable_extensions())
        ->required();
    command->add_option("--size", arguments->size, "WxH of the result")->required();
    command->add_option("--scheme", arguments->scheme, scheme_names())->required();
    command
        ->add_option("--guide", arguments->guide,
                     "full-resolution planes, of schemes that take them: of the size of the "
                     "result, or n times as wide and high for n x n samples per pixel")
        ->check(not_empty());
    command
        ->add_option("--channel", arguments->channels,
                     "PLANE=X,Y,Z: what both files call a plane, where the name is not known")
        ->take_all()
        ->allow_extra_args(false);
    for (const SchemeOption& row : scheme_options()) {
        if (row.flag.empty()) continue;
        if (row.name == "use_centre") {
            command->add_flag(std::string(row.flag), arguments->no_centre,
                              std::string(row.summary));
        } else {
            add_table_option(*command, row, arguments->options[std::string(row.name)]);
        }
    }
    command->add_option("--threads", arguments->threads, "default: all")
        ->check(CLI::Range(1, 1024));
    command->add_flag("--json", arguments->json, "print times and counts as JSON");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_upsample(*arguments); }; });
}

}  // namespace vecino
