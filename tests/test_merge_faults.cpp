// SPDX-License-Identifier: Apache-2.0
//
// vecino render --samples and vecino merge as a script sees them, mistakes included.
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "core/channel_file.h"
#include "core/image_io.h"
#include "core/part_file.h"
#include "tests/bad_input.h"
#include "tests/catch.h"

using namespace vecino;
using namespace vecino::test;

namespace {

const char* const kBox =
    R"({"camera": {"position": [0, 0, 3], "look_at": [0, 0, 0], "up": [0, 1, 0],
    "vertical_fov_degrees": 40}, "materials": {"m": {"albedo": [0.5, 0.5, 0.5], "emission": [1, 2, 3]}},
    "objects": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "m"}]})";

std::string render_line(const std::string& rest) {
    return "render box.json --size 6x4 --spp 200 " + rest;
}

void make_parts(const TempDir& dir) {
    dir.write("box.json", kBox);
    dir.write("copy.json", kBox);
    dir.write("other.json", std::string(kBox) + "\n");
    dir.write("gradient.json", R"({"pattern": "xy_gradient"})");
    dir.write("text.exr", "no image");
    for (const char* const line :
         {"--samples 0:64 -o a.exr", "--samples 64:128 -o b.exr", "--samples 128:200 -o c.exr",
          "--samples 64:192 -o wide.exr", "--samples 64:128 --seed 2 -o seed.exr",
          "--samples 64:128 --max-depth 3 -o depth.exr",
          "--samples 64:128 --sampler independent -o sampler.exr",
          "--samples 64:128 --size 6x5 -o size.exr", "--samples 64:128 --spp 201 -o spp.exr",
          "--samples 64:128 --simd-width 4 -o narrow.exr",
          "--samples 0:64 --simd-width 4 -o narrow0.exr",
          "--samples 64:128 --planes radiance -o planes.exr", "-o whole.exr",
          "-o whole.png --planes radiance", "--samples 0:128 --planes radiance -o low.exr",
          "--samples 128:200 --planes radiance -o high.exr"}) {
        std::string text = render_line(line);
        for (const char* const option : {"--size 6x4 ", "--spp 200 "}) {
            const std::string flag = std::string(option).substr(0, 6);
            if (std::string(line).find(flag) == std::string::npos) continue;
            text.erase(text.find(option), std::string(option).size());
        }
        check_success(dir, text);
    }
    check_success(dir, "render other.json --size 6x4 --spp 200 --samples 64:128 -o scene.exr");
    check_success(dir, "render copy.json --size 6x4 --spp 200 --samples 64:128 -o copy.exr");
}

/// A copy of a part with something changed.
template <class Change>
void write_changed(const TempDir& dir, const std::string& name, const Change& change,
                   const std::string& from = "b.exr") {
    ChannelFile file = load_channels(dir.path(from));
    change(file);
    std::vector<ChannelSource> sources;
    for (const Channel& channel : file.channels) {
        sources.push_back({channel.name, [&channel](std::size_t i) { return channel.values[i]; }});
    }
    save_channels(dir.path(name), file.size, sources, file.metadata);
}

/// Attributes of an image, but for its time.
Metadata lasting(const TempDir& dir, const std::string& name) {
    Metadata metadata = load_header(dir.path(name)).metadata;
    metadata.erase("seconds");
    return metadata;
}

bool same_channels(const TempDir& dir, const std::string& a, const std::string& b) {
    const ChannelFile one = load_channels(dir.path(a));
    const ChannelFile two = load_channels(dir.path(b));
    return one.size == two.size && one.channels.size() == two.channels.size() &&
           std::ranges::equal(one.channels, two.channels, [](const Channel& x, const Channel& y) {
               return x.name == y.name && x.values == y.values;
           });
}

}  // namespace

TEST_CASE("merged files are those of one render", "[merge][cli]") {
    const TempDir dir;
    make_parts(dir);
    for (const char* const line :
         {"merge a.exr b.exr c.exr -o m.exr", "merge c.exr a.exr b.exr -o m.exr --json",
          "merge a.exr copy.exr c.exr -o m.exr --planes all"}) {
        check_success(dir, line);
        CHECK(same_channels(dir, "m.exr", "whole.exr"));
        CHECK(lasting(dir, "m.exr") == lasting(dir, "whole.exr"));
    }
    check_success(dir, "merge c.exr b.exr -o right.exr");  // a larger part
    check_success(dir, "merge right.exr a.exr -o m.exr");
    CHECK(same_channels(dir, "m.exr", "whole.exr"));
    CHECK(lasting(dir, "m.exr") == lasting(dir, "whole.exr"));
    check_success(dir, render_line("--samples 64:200 -o direct.exr"));
    CHECK(same_channels(dir, "right.exr", "direct.exr"));
    CHECK(lasting(dir, "right.exr") == lasting(dir, "direct.exr"));
    check_success(dir, "merge low.exr high.exr -o m.png");
    CHECK(dir.read("m.png") == dir.read("whole.png"));
    check_success(dir, "merge a.exr b.exr c.exr -o few.exr --planes normal,id");
    CHECK(planes_of(load_frame(dir.path("few.exr"))) ==
          Planes{Plane::radiance, Plane::normal, Plane::id});
    const auto seconds = [&](const char* name) {
        return std::get<float>(load_header(dir.path(name)).metadata.at("seconds"));
    };
    CHECK(seconds("right.exr") == Approx(seconds("b.exr") + seconds("c.exr")));
}

// clang-format off
TEST_CASE("mistakes of merge and of samples", "[merge][bad_input]") {
    const TempDir dir;
    make_parts(dir);
    write_changed(dir, "half.exr", [](ChannelFile& file) { file.channels.back().values[3] = 0.5f; });
    write_changed(dir, "unknown.exr", [](ChannelFile& file) { file.channels.back().name = "Sum.Blue.3"; });
    write_changed(dir, "future.exr", [](ChannelFile& file) { file.metadata["part_format"] = 2; });
    write_changed(dir, "odd.exr", [](ChannelFile& file) { file.metadata["samples"] = "64:100"; });
    write_changed(dir, "no_spp.exr", [](ChannelFile& file) { file.metadata.erase("spp"); });
    write_changed(dir, "rays.exr", [](ChannelFile& file) { file.metadata["rays"] = "many"; });
    write_changed(dir, "plane.exr", [](ChannelFile& file) { file.metadata["planes"] = "radiance,colour"; });
    write_changed(dir, "no_hits.exr", [](ChannelFile& file) { file.metadata["samples"] = "0:64"; });
    const auto set_id = [](float id) {
        return [id](ChannelFile& file) { std::ranges::find(file.channels, "Id", &Channel::name)->values[3] = id; };
    };
    write_changed(dir, "nan_id.exr", set_id(std::numeric_limits<float>::quiet_NaN()), "a.exr");
    write_changed(dir, "large_id.exr", set_id(1e20f), "a.exr");
    const std::string render = render_line("-o o.exr --samples ");
    const std::string as_in_a = ", as in a.exr";
    const Mistake mistakes[] = {
        {"no samples", render, 64, "--samples"},
        {"empty samples", render + "\"\"", 64, "--samples: found nothing"},
        {"one number", render + "64", 64, "--samples: found \"64\", allowed: A:B, two integers"},
        {"half a pair", render + "64:", 64, "--samples: found \"64:\", allowed: A:B, two integers"},
        {"three numbers", render + "0:64:128", 64, "--samples: found \"0:64:128\", allowed: A:B, two integers"},
        {"a fraction", render + "0:64.5", 64, "--samples: found \"0:64.5\", allowed: A:B, two integers"},
        {"beyond 32 bits", render + "0:6400000000", 64, "--samples: found \"0:6400000000\", allowed: A:B, two integers"},
        {"negative samples", render + "-64:64", 64, "--samples: found -64:64, allowed: A:B with 0 <= A < B <= spp, which is 200"},
        {"no sample at all", render + "64:64", 64, "--samples: found 64:64, allowed: A:B with 0 <= A < B <= spp, which is 200"},
        {"samples backwards", render + "128:64", 64, "--samples: found 128:64, allowed: A:B with"},
        {"samples beyond spp", render + "128:256", 64, "--samples: found 128:256, allowed: A:B with 0 <= A < B <= spp, which is 200"},
        {"a begin within a block", render + "32:128", 64, "--samples: found 32:128, allowed: multiples of 64, or spp as the end"},
        {"an end within a block", render + "0:100", 64, "--samples: found 0:100, allowed: multiples of 64, or spp as the end"},
        {"a part as picture", render_line("-o o.png --samples 0:64"), 64, "o.png: found another extension, allowed with --samples: .exr"},
        {"samples of a pattern", "render gradient.json -o o.exr --samples 0:64", 64, "samples: found the scene gradient, which is a pattern"},
        {"bad samples before a missing scene", "render none.json -o o.exr --samples 0:3", 64, "--samples"},

        {"no part", "merge -o m.exr", 64, "PART is required"},
        {"no output", "merge a.exr b.exr", 64, "-o is required"},
        {"an unknown flag", "merge a.exr b.exr c.exr -o m.exr --loud", 64, "--loud"},
        {"an unknown extension", "merge a.exr -o m.gif", 64, "m.gif: found extension .gif, allowed: .exr"},
        {"an unknown plane", "merge a.exr b.exr c.exr -o m.exr --planes colour", 64, "--planes: found \"colour\""},
        {"planes of a larger part", "merge a.exr b.exr -o m.exr --planes radiance", 64, "--planes: found samples 0:128 alone, allowed: all, 0:200"},
        {"usage before a missing file", "merge none.exr -o m.gif", 64, "m.gif"},
        {"a part that is not there", "merge a.exr none.exr -o m.exr", 4, "none.exr: cannot be read: No such file or directory"},
        {"a part that is no image", "merge a.exr text.exr -o m.exr", 4, "text.exr: cannot be read: "},
        {"a folder that is not there", "merge a.exr b.exr c.exr -o none/m.exr", 4, "none/m.exr: cannot be written: none: "},
        {"a digit that is none", "merge a.exr half.exr c.exr -o m.exr", 4, "half.exr: cannot be read: channel "},
        {"a channel that is none", "merge a.exr unknown.exr c.exr -o m.exr", 4, "unknown.exr: cannot be read: channel Sum.Blue.3 is none of a part"},
        {"an id that is no number", "merge nan_id.exr b.exr c.exr -o m.exr", 4, "nan_id.exr: cannot be read: channel Id does not hold 32-bit integers"},
        {"an id beyond 32 bits", "merge large_id.exr b.exr c.exr -o m.exr", 4, "large_id.exr: cannot be read: channel Id does not hold 32-bit integers"},
        {"no samples that a render has", "merge a.exr odd.exr -o m.exr", 4, "odd.exr: cannot be read: attribute samples is \"64:100\""},
        {"no number of samples", "merge a.exr no_spp.exr -o m.exr", 4, "no_spp.exr: cannot be read: attribute spp is missing or damaged"},
        {"a damaged count", "merge a.exr rays.exr -o m.exr", 4, "rays.exr: cannot be read: attribute rays is \"many\""},
        {"damaged planes", "merge a.exr plane.exr -o m.exr", 4, "plane.exr: cannot be read: attribute planes is \"radiance,colour\""},
        {"no first hits", "merge no_hits.exr b.exr -o m.exr", 4, "no_hits.exr: cannot be read: channels of the first hit are missing"},

        {"a whole image", "merge a.exr whole.exr -o m.exr", 3, "whole.exr: found no part of a render, allowed: what vecino render --samples A:B writes"},
        {"a later format", "merge a.exr future.exr -o m.exr", 3, "future.exr: found part_format 2, allowed: 1"},
        {"another scene", "merge a.exr scene.exr -o m.exr", 3, "scene.exr: found scene_hash "},
        {"another seed", "merge a.exr seed.exr -o m.exr", 3, "seed.exr: found seed 2, allowed: 1" + as_in_a},
        {"another depth", "merge a.exr depth.exr -o m.exr", 3, "depth.exr: found depth 3, allowed: 2" + as_in_a},
        {"another sampler", "merge a.exr sampler.exr -o m.exr", 3, "sampler.exr: found sampler independent, allowed: sobol" + as_in_a},
        {"another size", "merge a.exr size.exr -o m.exr", 3, "size.exr: found size [6,5], allowed: [6,4]" + as_in_a},
        {"another spp", "merge a.exr spp.exr -o m.exr", 3, "spp.exr: found spp 201, allowed: 200" + as_in_a},
        {"another packet width", "merge narrow0.exr b.exr c.exr -o m.exr", 3, "b.exr: found simd_width "},
        {"other planes", "merge a.exr planes.exr -o m.exr", 3, "planes.exr: found planes radiance, allowed: radiance,direct"},
        {"a part twice", "merge a.exr b.exr b.exr c.exr -o m.exr", 3, "b.exr: found samples 64:128, which overlap 64:128 of b.exr, allowed: parts without overlap"},
        {"an overlap", "merge a.exr wide.exr c.exr -o m.exr", 3, "c.exr: found samples 128:200, which overlap 64:192 of wide.exr, allowed: parts without overlap"},
        {"a gap", "merge c.exr a.exr -o m.exr", 3, "c.exr: found samples 128:200 after 0:64 of a.exr, allowed: parts without a gap (64:128 is missing)"},
        {"a picture of some samples", "merge a.exr b.exr -o m.png", 3, "m.png: found samples 0:128 alone, allowed: all, 0:200"},
        {"planes that the parts lack", "merge low.exr high.exr -o m.exr --planes normal", 3, "--planes: found normal, allowed: planes that the parts were traced for"},
        {"a part as image", "compare a.exr whole.exr", 3, "a.exr: found a part of a render, allowed: an image (vecino merge makes one of parts)"},
    };
    check_mistakes(dir, mistakes);
}
// clang-format on
