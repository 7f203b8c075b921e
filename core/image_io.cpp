// SPDX-License-Identifier: Apache-2.0
#include "core/image_io.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/channel_file.h"
#include "core/color.h"
#include "core/error.h"
#include "core/exr_check.h"
#include "core/files.h"
#include "core/image_format.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/planes.h"
#include "core/png_check.h"

namespace vecino {
namespace {

using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// Rows read at a time.
constexpr int kReadRows = 64;

struct Source {
    std::string path;
    ImageInput::unique_ptr input;
    ImageSpec spec;
};

/// Where a plane's values stand in a file: three channels, or three times the same one.
struct Location {
    const PlaneInfo* plane;
    std::array<int, 3> channels;
};

Source open_source(const std::string& path) {
    require_readable(path);
    const std::string exr = exr_fault(read_beginning(path));
    if (!exr.empty()) cannot_read(path, exr);
    if (path.ends_with(".png")) {
        const std::string fault = png_fault(read_file(path));
        if (!fault.empty()) cannot_read(path, fault);
    }
    OIIO::attribute("tiff:multithread", 0);  // its other threads keep their errors to themselves
    ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);  // else colours come multiplied by alpha
    // By its extension: ImageInput::open() hands a broken file to all of the library's two dozen
    // decoders in turn.
    Source source{path, ImageInput::create(path), {}};
    if (!source.input) cannot_read(path, first_fault(OIIO::geterror()));
    if (!source.input->open(path, source.spec, hints)) {
        cannot_read(path, first_fault(source.input->geterror()));
    }
    const ImageSpec& spec = source.spec;
    if (spec.deep || spec.depth > 1) cannot_read(path, "deep and volume images are not supported");
    const std::string fault = size_fault({spec.width, spec.height});
    if (!fault.empty()) cannot_read(path, fault);
    return source;
}

[[noreturn]] void mismatch(const Source& source, const std::string& found,
                           const std::string& allowed) {
    // Names of channels are the file's: they may hold anything.
    throw Error(ExitCode::mismatch,
                one_line(source.path + ": found " + found + ", allowed: " + allowed));
}

std::string list(std::span<const std::string> names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

Extent size_of(const Source& source) {
    return {source.spec.width, source.spec.height};
}

bool is_integer(const ImageSpec& spec, int channel) {
    return !spec.channelformat(channel).is_floating_point();
}

/// -1 where there is none.
int channel_index(const ImageSpec& spec, std::string_view name) {
    const auto found = std::ranges::find(spec.channelnames, name);
    if (found == spec.channelnames.end()) return -1;
    return static_cast<int>(found - spec.channelnames.begin());
}

/// Grey counts as colour. Only EXR says what its channels are; elsewhere the first ones are colour.
std::optional<std::array<int, 3>> find_colour(const Source& source) {
    const ImageSpec& spec = source.spec;
    const bool named = std::string_view(source.input->format_name()) == "openexr";
    const std::array<int, 3> rgb = {channel_index(spec, "R"), channel_index(spec, "G"),
                                    channel_index(spec, "B")};
    if (std::ranges::min(rgb) >= 0) return rgb;
    if (!named && spec.nchannels >= 3) return {{0, 1, 2}};
    if (named && std::ranges::max(rgb) >= 0) return std::nullopt;
    const int grey = named ? channel_index(spec, "Y") : 0;
    if (grey < 0) return std::nullopt;
    return {{grey, grey, grey}};
}

Location locate_radiance(const Source& source) {
    const auto colour = find_colour(source);
    if (!colour) {
        if (source.spec.find_attribute(kPartFormat) != nullptr) {
            mismatch(source, "a part of a render", "an image (vecino merge makes one of parts)");
        }
        mismatch(source, "channels " + list(source.spec.channelnames), "R, G, B or Y among them");
    }
    return {&all_planes().front(), *colour};
}

/// Nothing if the file has no channel of the plane.
std::optional<Location> locate(const Source& source, const PlaneInfo& plane) {
    const std::span names(plane.channels.begin(), plane.channel_count());
    Location location{&plane, {}};
    std::vector<std::string> found;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string_view name = names[c % names.size()];
        location.channels[c] = channel_index(source.spec, name);
        if (c < names.size() && location.channels[c] >= 0) found.emplace_back(name);
    }
    if (found.empty()) return std::nullopt;
    if (found.size() < names.size()) mismatch(source, "only channels " + list(found), join(names));
    // OpenImageIO scales integers to [0,1], which would turn every identity into 0.
    if (is_integer(source.spec, location.channels[0])) {
        mismatch(source, "integers in channel " + found.front(), "floating-point values");
    }
    return location;
}

/// The channels that some locations name, as floats.
class Samples {
  public:
    Samples(const Source& source, std::span<const Location> locations) {
        int end = 0;
        first_ = source.spec.nchannels;
        for (const Location& location : locations) {
            first_ = std::min(first_, std::ranges::min(location.channels));
            end = std::max(end, std::ranges::max(location.channels) + 1);
        }
        stride_ = static_cast<std::size_t>(end - first_);
        const std::size_t count = size_of(source).area() * stride_;
        require_memory(2 * count * sizeof(float), source.path);  // once here, once as planes
        values_.resize(count);
        const bool whole =
            source.input->read_image(0, 0, first_, end, TypeDesc::FLOAT, values_.data());
        // Some readers (TIFF's up to 3.0) report a broken file and say yes all the same.
        const std::string reason = source.input->geterror();
        if (!whole || !reason.empty()) cannot_read(source.path, first_fault(reason));
    }

    [[nodiscard]] glm::vec3 at(std::size_t pixel, const std::array<int, 3>& channels) const {
        const float* values = &values_[pixel * stride_];
        return {values[channels[0] - first_], values[channels[1] - first_],
                values[channels[2] - first_]};
    }

  private:
    int first_ = 0;
    std::size_t stride_ = 0;
    std::vector<float> values_;
};

/// Sets one value of a plane; false if the samples cannot be one.
bool assign(glm::vec3& value, const glm::vec3& samples) {
    value = samples;
    return true;
}
bool assign(float& value, const glm::vec3& samples) {
    value = samples.x;
    return true;
}
bool assign(std::int32_t& value, const glm::vec3& samples) {
    constexpr float limit = 2147483648.0f;
    if (!(samples.x >= -limit && samples.x < limit)) return false;
    value = static_cast<std::int32_t>(std::lround(samples.x));
    return true;
}

void assemble(Frame& frame, const Location& location, const Source& source,
              const Samples& samples) {
    const auto fill = [&](auto member) {
        auto& plane = frame.*member;
        plane = std::remove_reference_t<decltype(plane)>(size_of(source));
        for (std::size_t i = 0; i < plane.values().size(); ++i) {
            const glm::vec3 found = samples.at(i, location.channels);
            if (assign(plane.values()[i], found)) continue;
            fail({found.x, i, plane.size().width, std::string(location.plane->channels[0])},
                 source.path, "32-bit integers");
        }
    };
    std::visit(fill, location.plane->member);
}

Frame read_planes(const Source& source, std::span<const Location> locations) {
    const Samples samples(source, locations);
    Frame frame;
    for (const Location& location : locations) assemble(frame, location, source, samples);
    if (is_integer(source.spec, locations.front().channels[0])) {
        for (glm::vec3& p : frame.radiance.values()) {
            p = {srgb_decode(p.r), srgb_decode(p.g), srgb_decode(p.b)};
        }
    }
    return frame;
}

/// Files of several parts hold one layer in each. False after the last.
bool next_part(Source& source) {
    const int next = source.input->current_subimage() + 1;
    if (!source.input->seek_subimage(next, 0)) {
        (void)source.input->geterror();  // there is none: no fault
        return false;
    }
    source.spec = source.input->spec();
    return true;
}

std::vector<float> read_channel(const Source& source, int channel, Extent size) {
    const std::string& name = source.spec.channelnames[static_cast<std::size_t>(channel)];
    if (is_integer(source.spec, channel))
        mismatch(source, "integers in channel " + name, "floating-point values");
    if (size_of(source) != size)
        mismatch(source, "channel " + name + " of " + size_text(size_of(source)),
                 size_text(size) + ", as the others");
    std::vector<float> values(size.area());
    if (!source.input->read_image(source.input->current_subimage(), 0, channel, channel + 1,
                                  TypeDesc::FLOAT, values.data()))
        cannot_read(source.path, first_fault(source.input->geterror()));
    return values;
}

Metadata metadata_of(const ImageSpec& spec) {
    Metadata metadata;
    for (const OIIO::ParamValue& attribute : spec.extra_attribs) {
        const std::string name = attribute.name().string();
        if (attribute.type() == TypeDesc::INT) {
            metadata[name] = attribute.get_int();
        } else if (attribute.type() == TypeDesc::FLOAT || attribute.type() == TypeDesc::DOUBLE) {
            metadata[name] = attribute.get_float();
        } else if (attribute.type() == TypeDesc::STRING) {
            metadata[name] = attribute.get_string();
        }
    }
    return metadata;
}

}  // namespace

Frame load_frame(const std::string& path) {
    const Source source = open_source(path);
    std::vector<Location> locations = {locate_radiance(source)};
    for (const PlaneInfo& plane : all_planes().subspan(1)) {
        if (const auto location = locate(source, plane)) locations.push_back(*location);
    }
    return read_planes(source, locations);
}

Image load_image(const std::string& path) {
    const Source source = open_source(path);
    const Location radiance = locate_radiance(source);
    return read_planes(source, {&radiance, 1}).radiance;
}

Image load_image(const std::string& path, const std::array<std::string, 3>& channels) {
    const Source source = open_source(path);
    Location radiance{&all_planes().front(), {}};
    for (std::size_t c = 0; c < 3; ++c) {
        radiance.channels[c] = channel_index(source.spec, channels[c]);
        if (radiance.channels[c] < 0)
            mismatch(source, "no channel " + channels[c], list(source.spec.channelnames));
    }
    return read_planes(source, {&radiance, 1}).radiance;
}

ChannelFile load_header(const std::string& path) {
    const Source source = open_source(path);
    return {size_of(source), metadata_of(source.spec), {}};
}

std::vector<ChannelInfo> list_channels(const std::string& path) {
    Source source = open_source(path);
    std::vector<ChannelInfo> channels;
    do {
        const ImageSpec& spec = source.spec;
        for (int c = 0; c < spec.nchannels; ++c) {
            const bool is_half = spec.channelformat(c) == TypeDesc::HALF;
            channels.push_back({spec.channelnames[static_cast<std::size_t>(c)], is_half});
        }
    } while (next_part(source));
    return channels;
}

ChannelFile load_channels(const std::string& path, std::span<const std::string> names) {
    Source source = open_source(path);
    ChannelFile file{size_of(source), metadata_of(source.spec), {}};
    require_memory((names.size() + 1) * file.size.area() * sizeof(float), path);
    std::vector<Channel> found(names.size());
    do {
        for (std::size_t i = 0; i < names.size(); ++i) {
            const int channel = channel_index(source.spec, names[i]);
            if (channel >= 0 && found[i].values.empty())
                found[i] = {names[i], read_channel(source, channel, file.size)};
        }
    } while (next_part(source));
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (found[i].values.empty())
            throw Error(ExitCode::mismatch, one_line(path + ": found no channel " + names[i] +
                                                     ", allowed: one of those that are there"));
    }
    file.channels = std::move(found);
    return file;
}

ChannelFile load_channels(const std::string& path) {
    const Source source = open_source(path);
    const ImageSpec& spec = source.spec;
    const Extent size = size_of(source);
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    const auto width = static_cast<std::size_t>(size.width);
    require_memory(size.area() * channels * sizeof(float), path);
    ChannelFile file{size, metadata_of(spec), {}};
    for (const std::string& name : spec.channelnames) {
        file.channels.push_back({name, std::vector<float>(size.area())});
    }
    std::vector<float> band(width * channels * kReadRows);
    for (int begin = 0; begin < size.height; begin += kReadRows) {
        const int end = std::min(begin + kReadRows, size.height);
        if (!source.input->read_scanlines(0, 0, begin, end, 0, 0, spec.nchannels, TypeDesc::FLOAT,
                                          band.data())) {
            cannot_read(path, first_fault(source.input->geterror()));
        }
        const std::size_t first = static_cast<std::size_t>(begin) * width;
        const std::size_t count = static_cast<std::size_t>(end - begin) * width;
        for (std::size_t c = 0; c < channels; ++c) {
            float* const to = &file.channels[c].values[first];
            for (std::size_t i = 0; i < count; ++i) to[i] = band[i * channels + c];
        }
    }
    return file;
}

std::string image_library_version() {
    return OIIO_VERSION_STRING;
}

}  // namespace vecino
