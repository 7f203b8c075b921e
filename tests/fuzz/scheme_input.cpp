// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/scheme_input.h"

#include <iterator>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/error.h"
#include "filters/guide.h"

namespace vecino::fuzz {
namespace {

using Json = nlohmann::json;

constexpr int kLongestSide = 12;

int side(Bytes& bytes) {
    return bytes.integer(1, kLongestSide);
}

void set_value(glm::vec3& value, Bytes& bytes) {
    value.x = bytes.real();
    value.y = bytes.real();
    value.z = bytes.real();
}
void set_value(float& value, Bytes& bytes) {
    value = bytes.real();
}
void set_value(std::int32_t& value, Bytes& bytes) {
    // mostly few objects and misses; now and then any number at all
    value = bytes.chance_in(16) ? static_cast<std::int32_t>(bytes.word()) : bytes.integer(-1, 3);
}

/// Mostly there and of the frame's size.
void fill_plane(Frame& frame, const PlaneInfo& plane, Bytes& bytes) {
    Extent size = frame.size();
    const std::uint8_t kind = bytes.byte();
    if (kind % 16 == 15) return;  // absent
    if (kind % 16 == 14) size = {side(bytes), side(bytes)};
    std::visit(
        [&](auto member) {
            auto& grid = frame.*member;
            grid = std::remove_reference_t<decltype(grid)>(size);
            for (auto& value : grid.values()) set_value(value, bytes);
        },
        plane.member);
}

Frame any_frame(Bytes& bytes) {
    Frame frame;
    const bool is_empty = bytes.chance_in(64);
    frame.radiance = Image(is_empty ? Extent{} : Extent{side(bytes), side(bytes)});
    for (glm::vec3& color : frame.radiance.values()) set_value(color, bytes);
    for (const PlaneInfo& plane : all_planes().subspan(1)) fill_plane(frame, plane, bytes);
    return frame;
}

glm::vec3 plausible(Plane plane, Bytes& bytes) {
    constexpr glm::vec3 kNormals[] = {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}, {0.6f, 0, 0.8f}, {0, 0, 0}};
    if (plane == Plane::normal) return kNormals[bytes.byte() % std::size(kNormals)];
    glm::vec3 value;
    for (int c = 0; c < 3; ++c) value[c] = static_cast<float>(bytes.byte());
    return plane == Plane::position ? value / 16.0f - 8.0f : value / 255.0f;
}

/// Planes that a renderer would write, for the most part.
Frame any_guide(Extent size, Bytes& bytes) {
    Frame guide;
    for (const PlaneInfo& plane : all_planes().subspan(1)) {
        if (!kGuidePlanes.has(plane.plane) || bytes.chance_in(8)) continue;
        const bool is_plausible = !bytes.chance_in(8);
        const auto fill = [&]<class T>(Grid<T> Frame::*member) {
            guide.*member = Grid<T>(size);
            for (T& value : (guide.*member).values()) {
                if constexpr (std::is_same_v<T, glm::vec3>) {
                    value = plausible(plane.plane, bytes);
                    if (is_plausible && !bytes.chance_in(64)) continue;
                }
                set_value(value, bytes);
            }
        };
        std::visit(fill, plane.member);
    }
    return guide;
}

/// Through the table, as matrices and the command line do.
SchemeParameters any_parameters(Bytes& bytes) {
    SchemeParameters parameters;
    for (const SchemeOption& option : scheme_options()) {
        const Json value = allowed_value(option.schema(), bytes);
        try {
            option.set(parameters, JsonValue(value, "fuzz", std::string(option.flag)));
        } catch (const Error&) {
            // a schema allows more than is read: the default stays
        }
    }
    if (bytes.chance_in(32)) parameters.window = static_cast<int>(bytes.word());
    return parameters;
}

/// Mostly one that there is a result of.
Extent any_size(Extent low, Bytes& bytes) {
    if (bytes.chance_in(32)) return {bytes.integer(-3, 40), bytes.integer(-3, 40)};
    return {low.width + bytes.integer(0, 30), low.height + bytes.integer(0, 30)};
}

Json integer_of(const Json& schema, Bytes& bytes) {
    const int least = schema.value("minimum", -1000);
    const int most = schema.value("maximum", 1000);
    const int near = std::min(most, least + 20);
    return bytes.chance_in(8) ? bytes.integer(least, most) : bytes.integer(least, near);
}

Json number_of(const Json& schema, Bytes& bytes) {
    const double least = schema.value("minimum", schema.value("exclusiveMinimum", -1.0e3));
    const double most = schema.value("maximum", std::max(1.0e3, least));
    const double share = bytes.byte() / 255.0;
    return least * (1.0 - share) + most * share;
}

}  // namespace

Json allowed_value(const Json& schema, Bytes& bytes) {
    if (schema.contains("enum")) {
        const Json& names = schema["enum"];
        return names[bytes.byte() % names.size()];
    }
    const Json type = schema.value("type", Json());
    if (type == "boolean") return bytes.byte() % 2 == 0;
    if (type == "integer") return integer_of(schema, bytes);
    if (type == "number") return number_of(schema, bytes);
    return nullptr;
}

SchemeInput scheme_input(Bytes bytes) {
    SchemeInput input;
    input.scheme = &all_schemes()[bytes.byte() % all_schemes().size()];
    input.request.parameters = any_parameters(bytes);
    input.low = any_frame(bytes);
    input.request.size = any_size(input.low.size(), bytes);
    input.request.threads = 1;
    const Extent size = input.request.size;
    if (!input.scheme->uses_guide() || size.width < 1 || size.height < 1) return input;
    const int scale = bytes.chance_in(4) ? 2 : 1;
    input.guide = any_guide({scale * size.width, scale * size.height}, bytes);
    return input;
}

}  // namespace vecino::fuzz
