// SPDX-License-Identifier: Apache-2.0
#include "eval/render_options.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "core/image_format.h"
#include "core/named_values.h"

namespace vecino {
namespace {

using Settings = const RenderSettings&;

constexpr int kMostSide = 65536;
constexpr int kMostInt = std::numeric_limits<int>::max();

constexpr Named<LightSampling> kLightSamplings[] = {
    {"none", LightSampling::none},
    {"nee", LightSampling::nee},
};
constexpr Named<Sampler> kSamplers[] = {
    {"independent", Sampler::independent},
    {"sobol", Sampler::sobol},
};
constexpr Named<FirstHit> kFirstHits[] = {
    {"first_sample", FirstHit::first_sample},
    {"centre", FirstHit::centre},
};

void set_size(RenderSettings& settings, const JsonValue& json) {
    const auto sides = json.raw().is_array() ? json.elements() : std::vector<JsonValue>{};
    if (sides.size() != 2) json.fail("WxH on the command line, [W, H] in a matrix");
    settings.size = {sides[0].integer(1, kMostSide), sides[1].integer(1, kMostSide)};
    if (!size_fault(settings.size).empty()) {
        json.fail("at most " + std::to_string(kMaxPixels) + " pixels");
    }
}

// clang-format off
const RenderOption kOptions[] = {
    {"size", "--size", "WxH, 1 to 65536 each", "full resolution of the image",
     set_size,
     [](Settings s) { return nlohmann::json{s.size.width, s.size.height}; },
     [](Settings s) { return size_text(s.size); }},
    {"reduction", "--reduction", "an integer >= 1", "trace floor(size / F), keeping the full aspect ratio",
     [](RenderSettings& s, const JsonValue& json) { s.reduction = json.integer(1, kMostSide); },
     [](Settings s) { return nlohmann::json(s.reduction); },
     [](Settings s) { return "f" + std::to_string(s.reduction); }},
    {"spp", "--spp", "an integer >= 1", "samples (paths) per traced pixel",
     [](RenderSettings& s, const JsonValue& json) { s.spp = json.integer(1, kMostInt); },
     [](Settings s) { return nlohmann::json(s.spp); },
     [](Settings s) { return "spp" + std::to_string(s.spp); }},
    {"max_depth", "--max-depth", "0 to 1000", "surface bounces that may carry light",
     [](RenderSettings& s, const JsonValue& json) { s.max_depth = json.integer(0, 1000); },
     [](Settings s) { return nlohmann::json(s.max_depth); },
     [](Settings s) { return "d" + std::to_string(s.max_depth); }},
    {"light_sampling", "--light-sampling", "none, nee", "none: light is found by chance; nee: next-event estimation",
     [](RenderSettings& s, const JsonValue& json) { s.light_sampling = value_of(kLightSamplings, json); },
     [](Settings s) { return nlohmann::json(name_of(kLightSamplings, s.light_sampling)); },
     [](Settings s) { return name_of(kLightSamplings, s.light_sampling); }},
    {"sampler", "--sampler", "independent, sobol", "sobol is Owen-scrambled",
     [](RenderSettings& s, const JsonValue& json) { s.sampler = value_of(kSamplers, json); },
     [](Settings s) { return nlohmann::json(name_of(kSamplers, s.sampler)); },
     [](Settings s) { return name_of(kSamplers, s.sampler); }},
    {"first_hit", "--first-hit", "first_sample, centre", "the ray whose first hit is kept",
     [](RenderSettings& s, const JsonValue& json) { s.first_hit = value_of(kFirstHits, json); },
     [](Settings s) { return nlohmann::json(name_of(kFirstHits, s.first_hit)); },
     [](Settings s) { return name_of(kFirstHits, s.first_hit); }},
    {"seed", "--seed", "0 to 2147483647", "of the random numbers",
     [](RenderSettings& s, const JsonValue& json) { s.seed = static_cast<std::uint32_t>(json.integer(0, kMostInt)); },
     [](Settings s) { return nlohmann::json(s.seed); },
     [](Settings s) { return "s" + std::to_string(s.seed); }},
};
// clang-format on

bool read_whole(std::string_view text, auto& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::span<const RenderOption> render_options() {
    return kOptions;
}

nlohmann::json option_value(const std::string& text) {
    long long integer = 0;
    if (read_whole(text, integer)) return integer;
    double number = 0;
    if (read_whole(text, number) && std::isfinite(number)) return number;  // JSON has no NaN
    const std::size_t cross = text.find('x');
    long long width = 0;
    long long height = 0;
    if (cross != std::string::npos && read_whole(text.substr(0, cross), width) &&
        read_whole(text.substr(cross + 1), height)) {
        return {width, height};
    }
    return text;
}

}  // namespace vecino
