// SPDX-License-Identifier: Apache-2.0
//
// The writing half of core/image_io.h and core/channel_file.h.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <vector>

#include "core/channel_file.h"
#include "core/color.h"
#include "core/error.h"
#include "core/files.h"
#include "core/image_format.h"
#include "core/image_io.h"
#include "core/planes.h"

namespace vecino {
namespace {

using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using OIIO::Filesystem::IOFile;

/// Rows written at a time: a multiple of what EXR compresses as one piece.
constexpr int kBandRows = 64;
constexpr int kPieceRows = 16;
constexpr std::size_t kBandBytes = std::size_t{1} << 26;
constexpr float kMaxRgbe = 1.0e38f;  // its shared exponent ends at 2^127

/// Fills one row of interleaved values.
template <class Value>
using FillRow = std::function<void(int y, Value* row)>;

template <class Value>
bool write_rows(ImageOutput& output, const ImageSpec& spec, const FillRow<Value>& fill) {
    const auto row_values =
        static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels);
    const bool wide = row_values * sizeof(Value) * kBandRows > kBandBytes;
    const int rows = std::min(wide ? kPieceRows : kBandRows, spec.height);
    std::vector<Value> band(row_values * static_cast<std::size_t>(rows));
    for (int begin = 0; begin < spec.height; begin += rows) {
        const int end = std::min(begin + rows, spec.height);
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
    if (!output) cannot_write(path, first_fault(OIIO::geterror()));
    bool whole = output->open(file.path(), spec);
    whole = whole && write_rows(*output, spec, fill);
    whole = output->close() && whole;
    const std::string reason = output->geterror();
    const bool refused = !whole && std::ferror(file.stream()) == 0;
    if (refused) cannot_write(path, first_fault(reason));
    file.replace_target();
}

ImageSpec make_spec(Extent size, int channels, const TypeDesc& type) {
    ImageSpec spec(size.width, size.height, channels, type);
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else it is the time of writing, and no two files are equal
    return spec;
}

void set_attributes(ImageSpec& spec, const Metadata& metadata) {
    for (const auto& [name, value] : metadata) {
        std::visit([&, &key = name](const auto& v) { spec.attribute(key, v); }, value);
    }
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

void write_bytes(const std::string& path, Extent size, const FillRow<std::uint8_t>& fill) {
    ImageSpec spec = make_spec(size, 3, TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    write_file<std::uint8_t>(path, spec, fill);
}

void save_encoded(const Image& image, const std::string& path) {
    const int width = image.size().width;
    write_bytes(path, image.size(), [&](int y, std::uint8_t* row) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) *row++ = quantise_8bit(srgb_encode(image(x, y)[c]));
        }
    });
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
    set_attributes(spec, metadata);
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
    const int width = raster.size().width;
    write_bytes(path, raster.size(), [&](int y, std::uint8_t* row) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) *row++ = raster(x, y)[c];
        }
    });
}

void save_channels(const std::string& path, Extent size, std::span<const ChannelSource> channels,
                   const Metadata& metadata) {
    if (content_of(path, ExitCode::file) != Content::planes) {
        cannot_write(path, "channels go into .exr files");
    }
    require_pixels(size, path);
    ImageSpec spec = make_spec(size, static_cast<int>(channels.size()), TypeDesc::FLOAT);
    spec.channelnames.clear();
    for (const ChannelSource& channel : channels) spec.channelnames.push_back(channel.name);
    set_attributes(spec, metadata);
    write_file<float>(path, spec, [&](int y, float* row) {
        const std::size_t first =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width);
        for (int x = 0; x < size.width; ++x) {
            for (const ChannelSource& channel : channels) {
                *row++ = channel.value(first + static_cast<std::size_t>(x));
            }
        }
    });
}

}  // namespace vecino
