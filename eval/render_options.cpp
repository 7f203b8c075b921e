// SPDX-License-Identifier: Apache-2.0
#include "eval/render_options.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "core/image_format.h"
#include "core/json_schema.h"

namespace vecino {
namespace {

using Settings = const RenderSettings&;

constexpr int kMostInt = std::numeric_limits<int>::max();

constexpr IntegerKind kSide{1, 65536};
constexpr IntegerKind kReduction{1, 65536};
constexpr IntegerKind kSpp{1, kMostInt};
constexpr IntegerKind kDepth{0, 1000};
constexpr RealKind kShift{{-65536.0, 65536.0}};
constexpr IntegerKind kSeed{0, kMostInt};
constexpr Named<LightSampling> kLightSamplings[] = {
    {"none", LightSampling::none},
    {"nee", LightSampling::nee},
};
constexpr Named<LightPoint> kLightPoints[] = {
    {"area", LightPoint::area},
    {"solid_angle", LightPoint::solid_angle},
};
constexpr Named<ControlVariate> kControlVariates[] = {
    {"none", ControlVariate::none},
    {"irradiance", ControlVariate::irradiance},
};
constexpr Named<LightChoice> kLightChoices[] = {
    {"power", LightChoice::power},
    {"contribution", LightChoice::contribution},
};
constexpr Named<MultipleImportance> kMultipleImportances[] = {
    {"none", MultipleImportance::none},
    {"balance", MultipleImportance::balance},
};
constexpr Named<Sampler> kSamplers[] = {
    {"independent", Sampler::independent},
    {"sobol", Sampler::sobol},
};
constexpr Named<FirstHit> kFirstHits[] = {
    {"first_sample", FirstHit::first_sample},
    {"centre", FirstHit::centre},
};
constexpr ChoiceKind kLightSampling{kLightSamplings};
constexpr ChoiceKind kLightPoint{kLightPoints};
constexpr ChoiceKind kControlVariate{kControlVariates};
constexpr ChoiceKind kLightChoice{kLightChoices};
constexpr ChoiceKind kMultipleImportance{kMultipleImportances};
constexpr ChoiceKind kSampler{kSamplers};
constexpr ChoiceKind kFirstHit{kFirstHits};

void set_size(RenderSettings& settings, const JsonValue& json) {
    const auto sides = json.raw().is_array() ? json.elements() : std::vector<JsonValue>{};
    if (sides.size() != 2) json.fail("WxH on the command line, [W, H] in a matrix");
    settings.size = {kSide.read(sides[0]), kSide.read(sides[1])};
    if (!size_fault(settings.size).empty()) {
        json.fail("at most " + std::to_string(kMaxPixels) + " pixels");
    }
}

void set_camera_shift(RenderSettings& settings, const JsonValue& json) {
    const auto numbers = json.raw().is_array() ? json.elements() : std::vector<JsonValue>{};
    if (numbers.size() != 2) json.fail("DX,DY on the command line, [DX, DY] in a matrix");
    settings.camera_shift = {kShift.read(numbers[0]), kShift.read(numbers[1])};
}

nlohmann::json camera_shift_schema() {
    return array_schema(kShift.schema(), {2, 2});
}

/// "shift0.25_0": the fewest digits that read back as the same numbers.
std::string camera_shift_slug(Settings s) {
    const auto digits = [](float value) {
        char text[32];
        return std::string(text, std::to_chars(std::begin(text), std::end(text), value).ptr);
    };
    return "shift" + digits(s.camera_shift.x) + "_" + digits(s.camera_shift.y);
}

nlohmann::json size_schema() {
    return array_schema(kSide.schema(), {2, 2});
}

// clang-format off
const RenderOption kOptions[] = {
    {"size", "--size", "WxH, 1 to 65536 each", "full resolution of the image",
     set_size,
     [](Settings s) { return nlohmann::json{s.size.width, s.size.height}; },
     [](Settings s) { return size_text(s.size); }, size_schema},
    {"reduction", "--reduction", "an integer >= 1", "trace floor(size / F), keeping the full aspect ratio",
     read_into<kReduction, &RenderSettings::reduction>,
     [](Settings s) { return nlohmann::json(s.reduction); },
     [](Settings s) { return "f" + std::to_string(s.reduction); }, schema_of<kReduction>},
    {"spp", "--spp", "an integer >= 1", "samples (paths) per traced pixel",
     read_into<kSpp, &RenderSettings::spp>,
     [](Settings s) { return nlohmann::json(s.spp); },
     [](Settings s) { return "spp" + std::to_string(s.spp); }, schema_of<kSpp>},
    {"max_depth", "--max-depth", "0 to 1000", "surface bounces that may carry light",
     read_into<kDepth, &RenderSettings::max_depth>,
     [](Settings s) { return nlohmann::json(s.max_depth); },
     [](Settings s) { return "d" + std::to_string(s.max_depth); }, schema_of<kDepth>},
    {"light_sampling", "--light-sampling", "none, nee", "none: light is found by chance; nee: next-event estimation",
     read_into<kLightSampling, &RenderSettings::light_sampling>,
     [](Settings s) { return nlohmann::json(name_of(kLightSamplings, s.light_sampling)); },
     [](Settings s) { return name_of(kLightSamplings, s.light_sampling); }, schema_of<kLightSampling>},
    {"light_point", "--light-point", "area, solid_angle", "of rectangular emitters: points uniform over which",
     read_into<kLightPoint, &RenderSettings::light_point>,
     [](Settings s) { return nlohmann::json(name_of(kLightPoints, s.light_point)); },
     [](Settings s) { return name_of(kLightPoints, s.light_point); }, schema_of<kLightPoint>},
    {"control_variate", "--control-variate", "none, irradiance", "of rectangular emitters: irradiance adds what is known exactly",
     read_into<kControlVariate, &RenderSettings::control_variate>,
     [](Settings s) { return nlohmann::json(name_of(kControlVariates, s.control_variate)); },
     [](Settings s) { return name_of(kControlVariates, s.control_variate); }, schema_of<kControlVariate>},
    {"light_choice", "--light-choice", "power, contribution", "of many emitters: chosen by power, or by what may reach the surface",
     read_into<kLightChoice, &RenderSettings::light_choice>,
     [](Settings s) { return nlohmann::json(name_of(kLightChoices, s.light_choice)); },
     [](Settings s) { return name_of(kLightChoices, s.light_choice); }, schema_of<kLightChoice>},
    {"multiple_importance", "--multiple-importance", "none, balance", "of emitters sampled by area: weigh in the light that bounces find",
     read_into<kMultipleImportance, &RenderSettings::multiple_importance>,
     [](Settings s) { return nlohmann::json(name_of(kMultipleImportances, s.multiple_importance)); },
     [](Settings s) { return name_of(kMultipleImportances, s.multiple_importance); }, schema_of<kMultipleImportance>},
    {"sampler", "--sampler", "independent, sobol", "sobol is Owen-scrambled",
     read_into<kSampler, &RenderSettings::sampler>,
     [](Settings s) { return nlohmann::json(name_of(kSamplers, s.sampler)); },
     [](Settings s) { return name_of(kSamplers, s.sampler); }, schema_of<kSampler>},
    {"first_hit", "--first-hit", "first_sample, centre", "the ray whose first hit is kept",
     read_into<kFirstHit, &RenderSettings::first_hit>,
     [](Settings s) { return nlohmann::json(name_of(kFirstHits, s.first_hit)); },
     [](Settings s) { return name_of(kFirstHits, s.first_hit); }, schema_of<kFirstHit>},
    {"camera_shift", "--camera-shift", "DX,DY, -65536 to 65536 each", "pixel (x, y) shows what is at (x + DX, y + DY) without it",
     set_camera_shift,
     [](Settings s) { return nlohmann::json{s.camera_shift.x, s.camera_shift.y}; },
     camera_shift_slug, camera_shift_schema},
    {"seed", "--seed", "0 to 2147483647", "of the random numbers",
     read_into<kSeed, &RenderSettings::seed>,
     [](Settings s) { return nlohmann::json(s.seed); },
     [](Settings s) { return "s" + std::to_string(s.seed); }, schema_of<kSeed>},
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
    const std::size_t comma = text.find(',');
    double x = 0;
    double y = 0;
    if (comma != std::string::npos && read_whole(text.substr(0, comma), x) &&
        read_whole(text.substr(comma + 1), y) && std::isfinite(x) && std::isfinite(y)) {
        return {x, y};
    }
    return text;
}

bool is_told(const RenderOption& row, const RenderSettings& settings) {
    return row.name != "camera_shift" || settings.camera_shift != glm::vec2(0.0f);
}

}  // namespace vecino
