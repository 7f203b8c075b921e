// SPDX-License-Identifier: Apache-2.0
#include "core/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "core/files.h"
#include "core/image_format.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/planes.h"
#include "core/png_check.h"

namespace vecino {
namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using OIIO::Filesystem::IOFile;

/// Rows written at a time: a multiple of what EXR compresses as one piece.
constexpr int kBandRows = 64;
constexpr float kMaxRgbe = 1.0e38f;  // its shared exponent ends at 2^127

/// OpenImageIO may list a dozen faults, one a line, that follow from the first.
std::string first_line(const std::string& text) {
    return text.empty() ? "no reason given" : text.substr(0, text.find('\n'));
}

// ---------------------------------------------------------------- writing

/// Fills one row of interleaved values.
template <class Value>
using FillRow = std::function<void(int y, Value* row)>;

template <class Value>
bool write_rows(ImageOutput& output, const ImageSpec& spec, const FillRow<Value>& fill) {
    const auto row_values =
        static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels);
    std::vector<Value> band(row_values *
                            static_cast<std::size_t>(std::min(kBandRows, spec.height)));
    for (int begin = 0; begin < spec.height; begin += kBandRows) {
        const int end = std::min(begin + kBandRows, spec.height);
        for (int y = begin; y < end; ++y) {
            fill(y, band.data() + static_cast<std::size_t>(y - begin) * row_values);
        }
        if (!output.write_scanlines(begin, end, 0, spec.format, band.data())) return false;
    }
    return true;
}

template <class Value>
void write_file(const std::string& path, const ImageSpec& spec, const FillRow<Value>& fill) {
    TemporaryFile file(path);
    // OpenImageIO's PNG and BMP do not notice a full disk; a stream of ours does.
    IOFile stream(file.stream(), IOFile::Write);
    const auto output = ImageOutput::create(file.path(), &stream);
    if (!output) cannot_write(path, first_line(OIIO::geterror()));
    bool whole = output->open(file.path(), spec);
    whole = whole && write_rows(*output, spec, fill);
    whole = output->close() && whole;
    const std::string reason = output->geterror();
    const bool refused = !whole && std::ferror(file.stream()) == 0;
    if (refused) cannot_write(path, first_line(reason));
    file.replace_target();
}

ImageSpec make_spec(Extent size, int channels, const TypeDesc& type) {
    ImageSpec spec(size.width, size.height, channels, type);
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else it is the time of writing, and no two files are equal
    return spec;
}

/// Writes three floats per pixel, each passed through convert.
void save_floats(const Image& image, const std::string& path, float (*convert)(float)) {
    const int width = image.size().width;
    write_file<float>(path, make_spec(image.size(), 3, TypeDesc::FLOAT), [&](int y, float* row) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) *row++ = convert(image(x, y)[c]);
        }
    });
}

void save_encoded(const Image& image, const std::string& path) {
    Grid<glm::u8vec3> raster(image.size());
    const auto encode = [](const glm::vec3& pixel) {
        glm::u8vec3 encoded;
        for (int c = 0; c < 3; ++c) encoded[c] = quantise_8bit(srgb_encode(pixel[c]));
        return encoded;
    };
    std::ranges::transform(image.values(), raster.values().begin(), encode);
    save_raster(raster, path);
}

/// One value of a plane.
float component(const glm::vec3& value, std::size_t c) {
    return value[static_cast<int>(c)];
}
float component(float value, std::size_t) {
    return value;
}
float component(std::int32_t value, std::size_t) {
    return static_cast<float>(value);
}

void save_planes(const Frame& frame, const std::string& path, const Metadata& metadata) {
    const std::vector<const PlaneInfo*> planes = planes_to_write(frame, path);
    ImageSpec spec = make_spec(frame.size(), 0, TypeDesc::FLOAT);
    for (const PlaneInfo* plane : planes) {
        for (std::size_t c = 0; c < plane->channel_count(); ++c) {
            spec.channelnames.emplace_back(plane->channels[c]);
        }
    }
    spec.nchannels = static_cast<int>(spec.channelnames.size());
    for (const auto& [name, value] : metadata) {
        std::visit([&, &key = name](const auto& v) { spec.attribute(key, v); }, value);
    }
    const auto stride = spec.channelnames.size();
    write_file<float>(path, spec, [&](int y, float* row) {
        for (const PlaneInfo* plane : planes) {
            const std::size_t channels = plane->channel_count();
            const auto fill = [&](auto member) {
                for (int x = 0; x < spec.width; ++x) {
                    const auto& value = (frame.*member)(x, y);
                    float* out = row + static_cast<std::size_t>(x) * stride;
                    for (std::size_t c = 0; c < channels; ++c) out[c] = component(value, c);
                }
            };
            std::visit(fill, plane->member);
            row += channels;
        }
    });
}

// ---------------------------------------------------------------- reading

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
    if (path.ends_with(".png")) {
        const std::string fault = png_fault(read_file(path));
        if (!fault.empty()) cannot_read(path, fault);
    }
    OIIO::attribute("tiff:multithread", 0);  // its other threads keep their errors to themselves
    ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);  // else colours come multiplied by alpha
    Source source{path, ImageInput::open(path, &hints), {}};
    if (!source.input) cannot_read(path, first_line(OIIO::geterror()));
    source.spec = source.input->spec(0);
    const ImageSpec& spec = source.spec;
    if (spec.deep || spec.depth > 1) cannot_read(path, "deep and volume images are not supported");
    const std::string fault = size_fault({spec.width, spec.height});
    if (!fault.empty()) cannot_read(path, fault);
    return source;
}

[[noreturn]] void mismatch(const Source& source, const std::string& found,
                           const std::string& allowed) {
    throw Error(ExitCode::mismatch, source.path + ": found " + found + ", allowed: " + allowed);
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
        if (!whole || !reason.empty()) cannot_read(source.path, first_line(reason));
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

}  // namespace

void save_frame(const Frame& frame, const std::string& path, const Metadata& metadata) {
    if (content_of(path, ExitCode::file) != Content::planes) {
        return save_image(frame.radiance, path);
    }
    require_pixels(frame.size(), path);
    save_planes(frame, path, metadata);
}

void save_image(const Image& image, const std::string& path) {
    const Content content = content_of(path, ExitCode::file);
    require_pixels(image.size(), path);
    switch (content) {
        case Content::planes:
        case Content::linear:
            return save_floats(image, path, [](float x) { return x; });
        case Content::rgbe:
            require_finite(image, path);
            return save_floats(image, path, [](float x) { return std::clamp(x, 0.0f, kMaxRgbe); });
        case Content::encoded:
            require_finite(image, path);
            return save_encoded(image, path);
    }
}

void save_raster(const Grid<glm::u8vec3>& raster, const std::string& path) {
    if (content_of(path, ExitCode::file) != Content::encoded) {
        cannot_write(path, "8-bit pictures go into .png and .bmp files");
    }
    require_pixels(raster.size(), path);
    ImageSpec spec = make_spec(raster.size(), 3, TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    write_file<std::uint8_t>(path, spec, [&](int y, std::uint8_t* row) {
        for (int x = 0; x < spec.width; ++x) {
            for (int c = 0; c < 3; ++c) *row++ = raster(x, y)[c];
        }
    });
}

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

std::string image_library_version() {
    return OIIO_VERSION_STRING;
}

}  // namespace vecino
