// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/frame_planes.h"
#include "core/image_io.h"
#include "core/part_file.h"
#include "core/timing.h"
#include "eval/commands.h"
#include "eval/part_metadata.h"
#include "eval/render_metadata.h"

namespace vecino {
namespace {

struct MergeArguments {
    std::vector<std::string> parts;
    std::string output;
    std::string planes;
    bool json = false;
};

bool is_exr(const std::string& path) {
    return path.ends_with(".exr");
}

/// Headers of all parts, sorted by samples, if they belong together.
std::vector<PartHeader> load_headers(const std::vector<std::string>& paths) {
    std::vector<PartHeader> parts;
    for (const std::string& path : paths) parts.push_back(load_part_header(path));
    std::ranges::stable_sort(parts, {}, [](const PartHeader& part) { return part.samples.begin; });
    require_one_render(parts);
    return parts;
}

SampleInterval all_samples(const std::vector<PartHeader>& parts) {
    return {parts.front().samples.begin, parts.back().samples.end};
}

bool is_whole(const std::vector<PartHeader>& parts) {
    return all_samples(parts) == SampleInterval{0, parts.front().spp};
}

void require_whole(const std::vector<PartHeader>& parts, const std::string& where, ExitCode code) {
    if (is_whole(parts)) return;
    const int spp = parts.front().spp;
    throw Error(code, where + ": found samples " + interval_text(all_samples(parts)) +
                          " alone, allowed: all, " + interval_text({0, spp}) +
                          " (some make a larger part, an .exr with all planes)");
}

/// What a render would have been asked for: the planes of the parts in .exr, radiance elsewhere.
Planes wanted_planes(const MergeArguments& arguments, Planes held) {
    if (arguments.planes.empty()) return is_exr(arguments.output) ? held : Planes{Plane::radiance};
    if (arguments.planes == "all") return held;
    const Planes wanted = parse_planes(arguments.planes);
    for (const PlaneInfo& info : all_planes()) {
        if (!wanted.has(info.plane) || held.has(info.plane)) continue;
        throw Error(ExitCode::mismatch, "--planes: found " + std::string(info.name) +
                                            ", allowed: planes that the parts were traced for");
    }
    return wanted;
}

/// Two parts are in memory at a time.
Part load_joined(const std::vector<PartHeader>& headers) {
    Part part = load_part(headers.front());
    for (std::size_t i = 1; i < headers.size(); ++i) join(part, load_part(headers[i]));
    return part;
}

void print_result(const MergeArguments& arguments, const std::vector<PartHeader>& parts,
                  const RenderStatistics& statistics, double seconds) {
    const SampleInterval samples = all_samples(parts);
    if (arguments.json) {
        nlohmann::json json = {{"time_s", {{"total", seconds}, {"render", statistics.trace_s}}},
                               {"parts", parts.size()},
                               {"first_sample", samples.begin},
                               {"last_sample", samples.end - 1},
                               {"whole", is_whole(parts)}};
        const nlohmann::json counts = render_json({.render = {{}, statistics}}, 0);
        for (const char* name :
             {"samples", "rays", "simd_width", "dropped_samples", "non_finite_pixels"}) {
            json[name] = counts.at(name);
        }
        std::printf("%s\n", json.dump().c_str());
        return;
    }
    std::printf("%s: %s, %zu parts, samples %s of %d%s\n", arguments.output.c_str(),
                size_text(parts.front().size).c_str(), parts.size(), interval_text(samples).c_str(),
                parts.front().spp, is_whole(parts) ? "" : ": a larger part");
}

ExitCode run_merge(const MergeArguments& arguments) {
    require_writable_extension(arguments.output);
    if (!arguments.planes.empty()) parse_planes(arguments.planes);
    const Stopwatch watch;
    const std::vector<PartHeader> parts = load_headers(arguments.parts);
    if (!arguments.planes.empty()) require_whole(parts, "--planes", ExitCode::usage);
    if (!is_exr(arguments.output)) require_whole(parts, arguments.output, ExitCode::mismatch);
    const Planes planes = wanted_planes(arguments, parts.front().planes);
    require_writable(arguments.output);
    RenderStatistics statistics = total_statistics(parts);
    if (is_whole(parts)) {
        const Frame frame = finish(load_joined(parts), planes, statistics.non_finite_pixels);
        save_frame(frame, arguments.output, image_metadata(parts));
    } else {
        save_part(load_joined(parts), arguments.output, part_metadata(parts));
    }
    print_result(arguments, parts, statistics, watch.seconds());
    return report_non_finite(statistics, arguments.output);
}

}  // namespace

void add_merge_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<MergeArguments>();
    CLI::App* const command =
        app.add_subcommand("merge", "join parts that render --samples A:B has traced");
    command
        ->add_option("PART", arguments->parts,
                     "parts of one render, in any order; some of them make a larger part, all of "
                     "them the image that one render would have made, bit for bit")
        ->required();
    command->add_option("-o", arguments->output, "image to write: " + writable_extensions())
        ->required();
    command
        ->add_option("--planes", arguments->planes,
                     "all that the parts were traced for, or a list such as radiance,normal,id")
        ->check(not_empty());
    command->add_flag("--json", arguments->json, "print times and counts as JSON");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_merge(*arguments); }; });
}

}  // namespace vecino
