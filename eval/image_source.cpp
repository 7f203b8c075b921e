// SPDX-License-Identifier: Apache-2.0
#include "eval/image_source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>

#include "core/channel_file.h"
#include "core/error.h"
#include "core/json_schema.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

constexpr TextKind kText{};

nlohmann::json command_schema() {
    return array_schema(kText.schema(), {1, 0});
}
nlohmann::json channels_schema() {
    return array_schema(kText.schema(), {3, 3});
}
nlohmann::json seconds_schema() {
    return {{"type", "number"}, {"minimum", 0}};
}
constexpr std::string_view kOutputs[] = {".exr", ".hdr", ".tif", ".png", ".bmp"};

nlohmann::json output_schema() {
    return {{"enum", kOutputs}};
}

void read_channels(ImageSource& source, const JsonValue& json) {
    const auto names = json.elements();
    if (names.size() != 3) json.fail("the names of three channels: red, green, blue");
    source.channels = {names[0].string(), names[1].string(), names[2].string()};
}

void read_command(ImageSource& source, const JsonValue& json) {
    for (const JsonValue& part : json.elements()) source.command.push_back(part.string());
    if (source.command.empty()) json.fail("a program and its arguments, one string each");
}

const PlaneInfo& plane_of(const JsonValue& json) {
    std::vector<std::string_view> names;
    for (const PlaneInfo& info : all_planes()) {
        if (info.name == json.string()) return info;
        names.push_back(info.name);
    }
    json.fail(join(names));
}

void read_planes(ImageSource& source, const JsonValue& json) {
    source.planes = {Plane::radiance};
    for (const JsonValue& name : json.elements()) source.planes.add(plane_of(name).plane);
}

nlohmann::json planes_schema() {
    nlohmann::json names;
    for (const PlaneInfo& info : all_planes()) names["enum"].push_back(info.name);
    return array_schema(names, {1, 0});
}

void read_output(ImageSource& source, const JsonValue& json) {
    source.output = json.string();
    if (std::ranges::find(kOutputs, source.output) == std::end(kOutputs)) json.fail(join(kOutputs));
}

// clang-format off
constexpr JsonKey<ImageSource> kKeys[] = {
    member_key<kText, &ImageSource::file>("file", Presence::optional, "a file, from the folder of the matrix; {scene}, {seed}, {spp}, ... are replaced"),
    {"command", Presence::optional, "a program and its arguments, run in the folder of the matrix; {output} is the file to write, {vecino} this program", read_command, command_schema},
    {"output", Presence::optional, "what kind of file the command writes", read_output, output_schema},
    {"planes", Presence::optional, "of the frame {input}, beside radiance; default: all but variance and means", read_planes, planes_schema},
    {"channels", Presence::optional, "the file's channels of red, green and blue", read_channels, channels_schema},
    {"time_s", Presence::optional, "seconds that the image took", [](ImageSource& s, const JsonValue& json) { s.time_s = json.number({0, 1e12}); }, seconds_schema},
    member_key<kText, &ImageSource::time_attribute>("time_attribute", Presence::optional, "the file's attribute that tells these: seconds, or [HH:]MM:SS"),
};
// clang-format on

std::vector<std::string> known_placeholders(bool is_command) {
    std::vector<std::string> names{"scene", "scene_file", "width", "height"};
    for (const RenderOption& row : render_options())
        if (row.name != "size") names.emplace_back(row.name);
    if (is_command) names.insert(names.end(), {"input", "output", "vecino"});
    return names;
}

/// Calls with_text for what stands as it is and with_name for what is in braces; false where braces
/// do not match.
bool walk_template(std::string_view text, const std::function<void(std::string_view)>& with_text,
                   const std::function<void(std::string_view)>& with_name) {
    while (!text.empty()) {
        const std::size_t brace = text.find_first_of("{}");
        with_text(text.substr(0, brace));
        if (brace == std::string_view::npos) return true;
        text.remove_prefix(brace);
        if (text.size() > 1 && text[1] == text[0]) {
            with_text(text.substr(0, 1));
            text.remove_prefix(2);
            continue;
        }
        const std::size_t end = text.find('}');
        if (text[0] == '}' || end == std::string_view::npos) return false;
        with_name(text.substr(1, end - 1));
        text.remove_prefix(end + 1);
    }
    return true;
}

void check_template(const std::string& text, const JsonValue& json, bool is_command) {
    const auto known = known_placeholders(is_command);
    std::string allowed;
    for (const std::string& name : known) allowed += (allowed.empty() ? "{" : ", {") + name + "}";
    const bool matched = walk_template(
        text, [](std::string_view) {},
        [&](std::string_view name) {
            if (std::ranges::find(known, name) == known.end())
                json.fail("{" + std::string(name) + "}", allowed);
        });
    if (!matched) json.fail("braces that do not match", allowed + "; {{ and }} are braces");
}

std::vector<std::string> templates_of(const ImageSource& source) {
    auto texts = source.command;
    if (!source.file.empty()) texts.push_back(source.file);
    return texts;
}

void check(const ImageSource& source, const JsonValue& json) {
    const bool is_command = !source.command.empty();
    if (is_command == !source.file.empty())
        json.fail(is_command ? "both \"file\" and \"command\"" : "neither \"file\" nor \"command\"",
                  "one of them");
    if (!is_command && json.has("output")) json.fail("\"output\" of a file", "it with a command");
    if (json.has("planes") && !source.reads_frame())
        json.at("planes").fail("planes, and no {input}", "them with a command that reads a frame");
    if (source.time_s && !source.time_attribute.empty())
        json.fail("both \"time_s\" and \"time_attribute\"", "one of them at most");
    for (const std::string& text : templates_of(source)) check_template(text, json, is_command);
    if (is_command && !source.reads("output"))
        json.at("command").fail("no {output}", "a command that is told which file to write");
}

std::string attribute_text(const Metadata& metadata, const std::string& name,
                           const std::string& path) {
    const auto found = metadata.find(name);
    if (found == metadata.end())
        throw Error(ExitCode::mismatch, path + ": found no attribute \"" + name +
                                            "\", allowed: one that tells the seconds it took");
    const auto as_text = [](const auto& value) {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>)
            return value;
        else
            return std::to_string(value);
    };
    return std::visit(as_text, found->second);
}

double attribute_seconds(const std::string& path, const std::string& name) {
    const std::string text = attribute_text(load_header(path).metadata, name, path);
    const auto seconds = seconds_of(text);
    if (seconds) return *seconds;
    throw Error(ExitCode::mismatch, path + ": attribute \"" + name + "\": found \"" + text +
                                        "\", allowed: seconds, or [HH:]MM:SS");
}

}  // namespace

Planes input_planes() {
    Planes planes;
    for (const PlaneInfo& info : all_planes()) {
        const bool is_wanted = Planes::all().has(info.plane) && info.plane != Plane::variance;
        if (is_wanted) planes.add(info.plane);
    }
    return planes;
}

bool ImageSource::reads(std::string_view placeholder) const {
    bool found = false;
    for (const std::string& text : templates_of(*this))
        walk_template(
            text, [](std::string_view) {},
            [&](std::string_view each) { found = found || each == placeholder; });
    return found;
}

ImageSource read_image_source(const std::string& name, const JsonValue& json) {
    ImageSource source;
    read_object(json, kKeys, source);
    source.name = name;
    source.json = json.raw();
    check(source, json);
    return source;
}

ImageSource read_reference_source(const JsonValue& json) {
    json.require_keys({"file", "channels"});
    ImageSource source;
    source.name = "reference";
    source.json = json.raw();
    source.file = json.at("file").string();
    if (json.has("channels")) read_channels(source, json.at("channels"));
    check_template(source.file, json.at("file"), false);
    return source;
}

nlohmann::json image_source_schema() {
    nlohmann::json schema = object_schema(kKeys);
    for (const char* key : {"file", "command"}) schema["oneOf"].push_back({{"required", {key}}});
    return schema;
}

Placeholders placeholders_of(const std::string& scene_file, const RenderSettings& settings) {
    Placeholders values{{"scene", std::filesystem::path(scene_file).stem().string()},
                        {"scene_file", std::filesystem::absolute(scene_file).string()},
                        {"width", std::to_string(settings.size.width)},
                        {"height", std::to_string(settings.size.height)},
                        {"vecino", std::filesystem::read_symlink("/proc/self/exe").string()}};
    for (const RenderOption& row : render_options()) {
        const nlohmann::json value = row.get(settings);
        if (row.name != "size")
            values[std::string(row.name)] =
                value.is_string() ? value.get<std::string>() : value.dump();
    }
    return values;
}

std::string fill_template(const std::string& text, const Placeholders& values) {
    std::string filled;
    walk_template(
        text, [&](std::string_view part) { filled += part; },
        [&](std::string_view name) { filled += values.at(std::string(name)); });
    return filled;
}

SourcedImage load_sourced_image(const ImageSource& source, const std::string& path) {
    SourcedImage result;
    if (source.channels) {
        result.frame.radiance = load_image(path, *source.channels);
    } else {
        result.frame = load_frame(path);
    }
    result.time_s = source.time_s.value_or(0.0);
    if (!source.time_attribute.empty())
        result.time_s = attribute_seconds(path, source.time_attribute);
    return result;
}

std::optional<double> seconds_of(const std::string& text) {
    double seconds = 0;
    int parts = 0;
    for (std::size_t at = 0; at <= text.size(); ++parts) {
        const std::size_t end = std::min(text.find(':', at), text.size());
        double value = 0;
        const auto [stop, error] = std::from_chars(text.data() + at, text.data() + end, value);
        const bool whole = error == std::errc() && stop == text.data() + end;
        if (!whole || !std::isfinite(value) || value < 0 || parts == 3) return std::nullopt;
        seconds = seconds * 60 + value;
        at = end + 1;
    }
    return seconds;
}

}  // namespace vecino
