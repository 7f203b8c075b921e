// SPDX-License-Identifier: Apache-2.0
//
// What makes our planes open as layers in other programs. The rules are theirs, read in their
// sources: tev 18dabdd (Image.cpp, Channel.cpp, ExrImageLoader.cpp) and Blender 5
// (openexr_api.cpp).
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/image_io.h"
#include "core/planes.h"
#include "tests/catch.h"
#include "tests/temp_dir.h"
#include "tests/test_images.h"

using namespace vecino;

namespace {

struct ExrFile {
    TempDir dir;
    std::unique_ptr<OIIO::ImageInput> input;

    explicit ExrFile(Planes planes) {
        save_frame(make_frame({6, 4}, planes), dir.path("a.exr"));
        input = OIIO::ImageInput::open(dir.path("a.exr"));
        REQUIRE(input);
    }
    [[nodiscard]] const std::vector<std::string>& channels() const {
        return input->spec().channelnames;
    }
};

using Groups = std::map<std::string, std::string>;  ///< name: its channels, one after the other

/// What stands before and after the last dot.
std::pair<std::string, std::string> split(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) return {"", name};
    return {name.substr(0, dot), name.substr(dot + 1)};
}

/// tev: a layer is what stands before the last dot; of it R, G, B or X, Y, Z become one colour
/// image, everything else a grey one.
Groups tev_groups(const std::vector<std::string>& names) {
    std::map<std::string, std::set<std::string>> layers;
    for (const std::string& name : names) layers[split(name).first].insert(split(name).second);
    Groups groups;
    for (auto& [layer, tails] : layers) {
        for (const auto& known : {std::vector{"R", "G", "B"}, std::vector{"X", "Y", "Z"}}) {
            std::string joined;
            for (const char* tail : known)
                if (tails.erase(tail) > 0) joined += tail;
            if (!joined.empty()) groups[layer + "(" + joined + ")"] = joined;
        }
        for (const std::string& tail : tails) groups[layer + "(" + tail + ")"] = tail;
    }
    return groups;
}

/// Blender: the last part of a name is the channel, the one before it the pass, what is left the
/// layer. R, G, B without a dot are the pass Combined, Z is Depth, any other name its own pass.
Groups blender_passes(const std::vector<std::string>& names) {
    Groups passes;
    for (const std::string& name : names) {
        const auto [rest, channel] = split(name);
        if (!rest.empty()) {
            const auto [layer, pass] = split(rest);
            CHECK(layer.empty());
            passes[pass] += channel;
        } else if (name.size() == 1) {
            passes[name == "Z" ? "Depth" : "Combined"] += name;
        } else {
            passes[name] += "X";
        }
    }
    return passes;
}

}  // namespace

TEST_CASE("tev shows each plane as one layer", "[exr_layers]") {
    const ExrFile file(Planes::all());
    CHECK(tev_groups(file.channels()) == Groups{{"(RGB)", "RGB"},
                                                {"(Z)", "Z"},
                                                {"(Id)", "Id"},
                                                {"(SampleCount)", "SampleCount"},
                                                {"Direct(RGB)", "RGB"},
                                                {"Indirect(RGB)", "RGB"},
                                                {"Emission(RGB)", "RGB"},
                                                {"Albedo(RGB)", "RGB"},
                                                {"Variance(RGB)", "RGB"},
                                                {"P(XYZ)", "XYZ"},
                                                {"N(XYZ)", "XYZ"}});
}

TEST_CASE("Blender opens each plane as one pass", "[exr_layers]") {
    const ExrFile file(Planes::all());
    Groups passes = blender_passes(file.channels());
    for (auto& [name, channels] : passes) std::ranges::sort(channels);
    CHECK(passes == Groups{{"Combined", "BGR"},
                           {"Depth", "Z"},
                           {"Id", "X"},
                           {"SampleCount", "X"},
                           {"Direct", "BGR"},
                           {"Indirect", "BGR"},
                           {"Emission", "BGR"},
                           {"Albedo", "BGR"},
                           {"Variance", "BGR"},
                           {"P", "XYZ"},
                           {"N", "XYZ"}});
}

TEST_CASE("an EXR file is one unnamed part of scanlines that fills its display window",
          "[exr_layers]") {
    for (const Planes planes : {Planes::all(), Planes{Plane::radiance}}) {
        const ExrFile file(planes);
        const OIIO::ImageSpec& spec = file.input->spec();
        CHECK(spec.tile_width == 0);
        CHECK(std::vector{spec.x, spec.y, spec.width, spec.height} == std::vector{0, 0, 6, 4});
        CHECK(std::vector{spec.full_x, spec.full_y, spec.full_width, spec.full_height} ==
              std::vector{0, 0, 6, 4});
        // A part's name would become a layer around all others; two parts would be two layers.
        CHECK(spec.get_string_attribute("oiio:subimagename").empty());
        CHECK_FALSE(file.input->seek_subimage(1, 0));
        // Linear Rec. 709, as both take it without a word.
        CHECK(spec.find_attribute("chromaticities") == nullptr);
        CHECK(spec.alpha_channel == -1);
    }
}

TEST_CASE("the first three channels of an EXR file are its colour", "[exr_layers]") {
    // Viewers that know no layers show these.
    const ExrFile file(Planes::all());
    CHECK(std::vector(file.channels().begin(), file.channels().begin() + 3) ==
          std::vector<std::string>{"R", "G", "B"});
}
