// SPDX-License-Identifier: Apache-2.0
#include "core/image_format.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <vector>

#include "core/image_io.h"
#include "core/json_read.h"
#include "core/planes.h"

namespace vecino {
namespace {

struct Format {
    std::string_view extension;
    Content content;
};

constexpr Format kFormats[] = {
    {".exr", Content::planes},  {".hdr", Content::rgbe},    {".tif", Content::linear},
    {".tiff", Content::linear}, {".png", Content::encoded}, {".bmp", Content::encoded},
};

/// Case does not count: .PNG is a PNG.
std::string extension_of(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return extension;
}

}  // namespace

std::string first_fault(const std::string& text) {
    return text.empty() ? "no reason given" : text.substr(0, text.find('\n'));
}

Content content_of(const std::string& path, ExitCode code) {
    const std::string extension = extension_of(path);
    const Format* row = std::ranges::find(kFormats, extension, &Format::extension);
    if (row != std::end(kFormats)) return row->content;
    throw Error(code, path + ": found " +
                          (extension.empty() ? "no extension" : "extension " + extension) +
                          ", allowed: " + writable_extensions());
}

std::string writable_extensions() {
    std::vector<std::string_view> names;
    for (const Format& format : kFormats) names.push_back(format.extension);
    return join(names);
}

void require_writable_extension(const std::string& path) {
    content_of(path, ExitCode::usage);
}

std::string size_fault(Extent size) {
    const long long pixels = 1LL * size.width * size.height;
    if (size.width > 0 && pixels > 0 && pixels <= kMaxPixels) return "";
    return "found an image of " + size_text(size) + ", allowed: 1 to " +
           std::to_string(kMaxPixels) + " pixels";
}

void require_pixels(Extent size, const std::string& path) {
    const std::string fault = size_fault(size);
    if (!fault.empty()) throw Error(ExitCode::mismatch, path + ": " + fault);
}

std::vector<const PlaneInfo*> planes_to_write(const Frame& frame, const std::string& path) {
    std::vector<const PlaneInfo*> planes;
    const Planes held = planes_of(frame);
    for (const PlaneInfo& info : all_planes()) {
        if (!held.has(info.plane)) continue;
        const Extent size =
            std::visit([&](auto member) { return (frame.*member).size(); }, info.member);
        if (size != frame.size()) {
            throw Error(ExitCode::mismatch, path + ": found plane " + std::string(info.name) +
                                                " of " + size_text(size) +
                                                ", allowed: " + size_text(frame.size()));
        }
        planes.push_back(&info);
    }
    return planes;
}

void require_finite(const Image& image, const std::string& path) {
    const std::vector<glm::vec3>& pixels = image.values();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            if (std::isfinite(pixels[i][c])) continue;
            fail({pixels[i][c], i, image.size().width, std::string(1, "RGB"[c])}, path,
                 "finite numbers");
        }
    }
}

void fail(const BadValue& bad, const std::string& path, const std::string& allowed) {
    const auto width = static_cast<std::size_t>(bad.width);
    const std::string value = std::isnan(bad.value) ? "nan" : std::to_string(bad.value);
    throw Error(ExitCode::non_finite, path + ": found " + value + " at pixel (" +
                                          std::to_string(bad.index % width) + ", " +
                                          std::to_string(bad.index / width) + "), channel " +
                                          bad.channel + ", allowed: " + allowed);
}

}  // namespace vecino
