// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <map>
#include <memory>

#include "core/files.h"
#include "core/image_io.h"
#include "core/timing.h"
#include "eval/commands.h"
#include "eval/render_options.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

struct UpsampleArguments {
    std::string input;
    std::string output;
    std::string size;
    std::string scheme;
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

SchemeParameters parameters_of(const UpsampleArguments& arguments) {
    SchemeParameters parameters;
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
            {"non_finite_pixels", result.non_finite_pixels}};
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
    const ReconstructionRequest request{size_of(arguments.size), parameters_of(arguments),
                                        arguments.threads};
    require_writable(arguments.output);
    const Stopwatch read_watch;
    const Frame low = load_frame(arguments.input);
    require_planes(scheme, low, arguments.input);
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
    for (const SchemeOption& row : scheme_options()) {
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
