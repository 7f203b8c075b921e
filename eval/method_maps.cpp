// SPDX-License-Identifier: Apache-2.0
#include "eval/method_maps.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/channel_file.h"
#include "core/error.h"
#include "core/image_io.h"
#include "eval/colour_map.h"

namespace vecino {
namespace {

constexpr int kGap = 4;  ///< pixels between two pictures

struct NamedMap {
    std::string name;
    const Grid<float>* values;
};

std::vector<NamedMap> all_maps(const Grid<float>& sample_count, const MethodRender& render) {
    std::vector<NamedMap> maps{{"SampleCount", &sample_count}};
    for (const MethodMap& map : render.maps) maps.push_back({std::string(map.name), &map.values});
    return maps;
}

void draw(const Grid<float>& map, int left, Grid<glm::u8vec3>& picture) {
    const float most = *std::ranges::max_element(map.values());
    for (int y = 0; y < map.size().height; ++y) {
        for (int x = 0; x < map.size().width; ++x)
            picture(left + x, y) = sequential_colour(most > 0 ? map(x, y) / most : 0.0f);
    }
}

}  // namespace

void require_map_extension(const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension == ".exr" || extension == ".png" || extension == ".bmp") return;
    throw Error(ExitCode::usage, path + ": found extension \"" + extension +
                                     "\", allowed for --maps: .exr, .png, .bmp");
}

void save_method_maps(const Grid<float>& sample_count, const MethodRender& render,
                      const std::string& path) {
    const std::vector<NamedMap> maps = all_maps(sample_count, render);
    const Extent size = sample_count.size();
    if (std::filesystem::path(path).extension() == ".exr") {
        std::vector<ChannelSource> channels;
        for (const NamedMap& map : maps)
            channels.push_back(
                {map.name, [&map](std::size_t i) { return map.values->values()[i]; }});
        return save_channels(path, size, channels, {});
    }
    const int count = static_cast<int>(maps.size());
    Grid<glm::u8vec3> picture({count * (size.width + kGap) - kGap, size.height}, glm::u8vec3(255));
    for (int i = 0; i < count; ++i)
        draw(*maps[static_cast<std::size_t>(i)].values, i * (size.width + kGap), picture);
    save_raster(picture, path);
}

}  // namespace vecino
