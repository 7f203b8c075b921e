// SPDX-License-Identifier: Apache-2.0
//
// What image programs do without knowing the scene: anchors for the charts.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "core/files.h"
#include "core/image_io.h"
#include "core/named_values.h"
#include "core/timing.h"
#include "eval/commands.h"
#include "eval/render_metadata.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

constexpr Named<cv::InterpolationFlags> kFilters[] = {
    {"nearest", cv::INTER_NEAREST},
    {"bilinear", cv::INTER_LINEAR},
    {"bicubic", cv::INTER_CUBIC},
    {"lanczos", cv::INTER_LANCZOS4},
};

struct ResizeArguments {
    std::string input, output, size;
    std::string filter = "bicubic";
    int repeat = 1;
    bool json = false;
};

ExitCode run_resize(const ResizeArguments& arguments) {
    require_writable_extension(arguments.output);
    const nlohmann::json value = option_value(arguments.size);
    RenderSettings settings;
    for (const RenderOption& row : render_options()) {
        if (row.name == "size") row.set(settings, JsonValue(value, "command line", "--size"));
    }
    require_writable(arguments.output);
    Frame frame = load_frame(arguments.input);
    const Extent low = frame.size();
    const cv::Mat source(low.height, low.width, CV_32FC3, frame.radiance.values().data());
    Frame result;
    result.radiance = Image(settings.size);
    cv::Mat target(settings.size.height, settings.size.width, CV_32FC3,
                   result.radiance.values().data());
    const auto filter =
        std::ranges::find(kFilters, arguments.filter, &Named<cv::InterpolationFlags>::name)->value;
    std::vector<double> times;
    for (int i = 0; i < arguments.repeat; ++i) {
        const Stopwatch watch;
        cv::resize(source, target, target.size(), 0, 0, filter);
        times.push_back(watch.seconds());
    }
    const double resize_s = median(times);
    save_frame(result, arguments.output, {{"seconds", static_cast<float>(resize_s)}});
    if (arguments.json) {
        std::printf("%s\n", nlohmann::json{{"time_s", {{"reconstruct", resize_s}}}}.dump().c_str());
    } else {
        std::printf("%s: %s, %s, %.2f ms\n", arguments.output.c_str(), arguments.size.c_str(),
                    arguments.filter.c_str(), 1e3 * resize_s);
    }
    RenderStatistics counts;
    counts.non_finite_pixels = static_cast<std::uint64_t>(std::ranges::count_if(
        result.radiance.values(), [](const glm::vec3& rgb) { return !is_finite(rgb); }));
    return report_non_finite(counts, arguments.output);
}

}  // namespace

void add_resize_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<ResizeArguments>();
    CLI::App* const command = app.add_subcommand(
        "resize", "enlarge an image by colour alone (OpenCV): an anchor for charts");
    command->add_option("IMAGE", arguments->input, "image to enlarge")->required();
    command->add_option("-o", arguments->output, "image to write: " + writable_extensions())
        ->required();
    command->add_option("--size", arguments->size, "WxH of the result")->required();
    std::vector<std::string> names;
    for (const auto& row : kFilters) names.emplace_back(row.name);
    command->add_option("--filter", arguments->filter, "nearest, bilinear, bicubic, lanczos")
        ->check(CLI::IsMember(names));
    command
        ->add_option("--repeat", arguments->repeat,
                     "resize so often; the attribute \"seconds\" tells the median time of one")
        ->check(CLI::Range(1, 1000));
    command->add_flag("--json", arguments->json, "print the time as JSON");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_resize(*arguments); }; });
}

}  // namespace vecino
