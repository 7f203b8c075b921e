// SPDX-License-Identifier: Apache-2.0
#include "eval/render_metadata.h"

#include <cstdio>

#include "eval/render_options.h"

namespace vecino {
namespace {

struct AttributeText {
    std::string operator()(const std::string& text) const { return text; }
    std::string operator()(auto number) const { return std::to_string(number); }
};

std::string decibel_text(double decibels) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f dB", decibels);
    return text;
}

}  // namespace

Metadata render_metadata(const std::string& scene, const RenderSettings& settings, double seconds) {
    Metadata metadata{{"scene", scene},
                      {"version", VECINO_VERSION},
                      {"seconds", static_cast<float>(seconds)},
                      {"method", std::string(all_methods().front().name)}};
    for (const RenderOption& row : render_options()) {
        const nlohmann::json value = row.get(settings);
        const std::string key = row.name == "max_depth" ? "depth" : std::string(row.name);
        if (value.is_number_integer() || value.is_number_unsigned()) {
            metadata[key] = value.get<int>();
        } else {
            metadata[key] = value.is_string() ? value.get<std::string>() : value.dump();
        }
    }
    return metadata;
}

void describe_method(const Method& method, const MethodParameters& parameters, Metadata& metadata) {
    metadata["method"] = std::string(method.name);
    for (const MethodOption& row : method_options()) {
        if (method.reads(row.name)) metadata[std::string(row.name)] = row.get(parameters).dump();
    }
}

void describe_schedule(const MethodRender& result, Metadata& metadata) {
    const auto schedule = result.facts.find("schedule");
    if (schedule != result.facts.end()) metadata["schedule"] = schedule->get<std::string>();
}

void report_schedule(const MethodRender& result) {
    const nlohmann::json& facts = result.facts;
    if (!facts.contains("schedule")) return;
    std::string predicted;
    for (const auto& [method, decibels] : facts["predicted_by_method"].items()) {
        predicted += predicted.empty() ? "" : ", ";
        predicted += method + " " + (decibels.is_null() ? "unknown" : decibel_text(decibels));
    }
    const RenderStatistics& s = result.render.statistics;
    std::fprintf(stderr, "auto: %s: %s (predicted: %s); %.3f s; again by %s\n",
                 facts["chosen"].get<std::string>().c_str(),
                 facts["reason"].get<std::string>().c_str(), predicted.c_str(),
                 s.trace_s + result.reconstruct_s, facts["schedule"].get<std::string>().c_str());
}

std::string attribute_text(const Metadata& metadata, const std::string& name) {
    const auto found = metadata.find(name);
    return found == metadata.end() ? "none" : std::visit(AttributeText{}, found->second);
}

nlohmann::json render_json(const MethodRender& result, double write_s) {
    const RenderStatistics& s = result.render.statistics;
    return {{"time_s",
             {{"total", s.scene_s + s.trace_s + result.reconstruct_s + write_s},
              {"scene", s.scene_s},
              {"trace", s.trace_s},
              {"reconstruct", result.reconstruct_s},
              {"stages", result.stage_s},
              {"write", write_s}}},
            {"samples", s.samples},
            {"rays", s.rays},
            {"samples_per_s", s.trace_s > 0 ? static_cast<double>(s.samples) / s.trace_s : 0.0},
            {"threads", s.threads},
            {"simd_width", s.simd_width},
            {"dropped_samples", s.dropped_samples},
            {"non_finite_pixels", s.non_finite_pixels},
            {"facts", result.facts}};
}

ExitCode report_non_finite(const RenderStatistics& s, const std::string& output) {
    if (s.non_finite_pixels > 0) {
        std::fprintf(stderr, "error: %s: %llu pixels are not finite\n", output.c_str(),
                     static_cast<unsigned long long>(s.non_finite_pixels));
        return ExitCode::non_finite;
    }
    if (s.dropped_samples > 0) {
        std::fprintf(stderr, "warning: %llu samples were not finite and were left out\n",
                     static_cast<unsigned long long>(s.dropped_samples));
    }
    return ExitCode::ok;
}

}  // namespace vecino
