// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <map>
#include <memory>

#include "core/files.h"
#include "core/parallel.h"
#include "eval/bench.h"
#include "eval/commands.h"
#include "eval/progress.h"
#include "eval/render_options.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

struct BenchArguments {
    std::vector<std::string> scenes = bench_scene_names();
    std::map<std::string, std::string> options;  ///< "size" and "spp", as given
    BenchSettings settings;
    std::string output;
    bool json = false;
};

bool is_option(const RenderOption& row) {
    return row.name == "size" || row.name == "spp";
}

BenchSettings settings_of(const BenchArguments& arguments) {
    RenderSettings render;
    render.size = arguments.settings.size;
    render.spp = arguments.settings.spp;
    for (const RenderOption& row : render_options()) {
        const auto given = arguments.options.find(std::string(row.name));
        if (given == arguments.options.end() || given->second.empty()) continue;
        const nlohmann::json value = option_value(given->second);
        row.set(render, JsonValue(value, "command line", std::string(row.flag)));
    }
    BenchSettings settings = arguments.settings;
    settings.size = render.size;
    settings.spp = render.spp;
    return settings;
}

nlohmann::json result_json(const BenchReport& report, const BenchSettings& settings) {
    nlohmann::json json = bench_json(report);
    json["host"] = version_json();
    json["date"] = utc_time();
    json["size"] = {settings.size.width, settings.size.height};
    json["spp"] = settings.spp;
    json["repeats"] = settings.repeats;
    json["threads"] = settings.threads > 0 ? settings.threads : default_thread_count();
    return json;
}

BenchReport measure(const std::vector<BenchScene>& scenes, const BenchSettings& settings) {
    const auto shown = [](const std::string& label, const auto& work) {
        ProgressBar bar(label);
        return work([&](double done) { return bar.update(done); });
    };
    BenchReport report;
    report.tracing = shown("bench tracing", [&](const Progress& progress) {
        return bench_tracing(scenes, settings, progress);
    });
    report.schemes = shown("bench schemes", [&](const Progress& progress) {
        return bench_schemes(scenes.front(), settings, progress);
    });
    report.planes = shown("bench planes", [&](const Progress& progress) {
        return bench_planes(scenes, settings, progress);
    });
    return report;
}

ExitCode run_bench(const BenchArguments& arguments) {
    const BenchSettings settings = settings_of(arguments);
    std::vector<BenchScene> scenes;
    for (const std::string& name : arguments.scenes) scenes.push_back(bench_scene(name));
    if (!arguments.output.empty()) require_writable(arguments.output);
    catch_interrupts();
    const BenchReport report = measure(scenes, settings);
    const std::string json = result_json(report, settings).dump(2) + "\n";
    if (!arguments.output.empty()) write_text_file(arguments.output, json);
    std::fputs(arguments.json ? json.c_str() : bench_text(report).c_str(), stdout);
    return ExitCode::ok;
}

std::string scene_list() {
    std::string list;
    for (const std::string& name : bench_scene_names()) list += (list.empty() ? "" : ", ") + name;
    return list;
}

}  // namespace

void add_bench_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<BenchArguments>();
    CLI::App* const command = app.add_subcommand(
        "bench", "how fast this machine traces and rebuilds, against one ray at a time");
    command
        ->add_option("SCENE", arguments->scenes,
                     "scene files, or some of " + scene_list() + " (default: these)")
        ->type_name("");
    for (const RenderOption& row : render_options()) {
        if (!is_option(row)) continue;
        add_table_option(*command, row, arguments->options[std::string(row.name)]);
    }
    command
        ->add_option("--repeats", arguments->settings.repeats,
                     "rounds behind every median (default 5)")
        ->check(CLI::Range(1, 10000));
    command->add_option("--threads", arguments->settings.threads, "default: all")
        ->check(CLI::Range(1, 1024));
    command->add_option("-o", arguments->output, "also write the numbers there, as JSON")
        ->check(not_empty());
    command->add_flag("--json", arguments->json, "print the numbers as JSON");
    command->footer(
        "Renders are 128x128 at 16 spp unless told otherwise. Keys of the JSON, beside "
        "host, date, size, spp,\nrepeats and threads; all units are s and 1/s:\n" +
        bench_key_text());
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_bench(*arguments); }; });
}

}  // namespace vecino
