// SPDX-License-Identifier: Apache-2.0
//
// Planes by the names that renderers give them.
#include "core/renderer_channels.h"

#include "core/channel_file.h"
#include "core/error.h"
#include "core/image_io.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/foreign_image.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

using Names = std::vector<std::string>;

Names found(Plane plane, const Names& channels) {
    return find_plane(plane, channels, "a.exr").value_or(Names{});
}

Names layer(const std::string& name, const std::string& tails) {
    Names names;
    for (const char tail : tails) names.push_back(name + "." + tail);
    return names;
}

Names all_of(std::initializer_list<Names> lists) {
    Names names;
    for (const Names& list : lists) names.insert(names.end(), list.begin(), list.end());
    return names;
}

std::string data(const std::string& name) {
    return std::string(VECINO_SOURCE_DIR) + "/tests/data/" + name;
}

Names names_in(const std::string& file) {
    Names names;
    for (const ChannelInfo& info : list_channels(data(file))) names.push_back(info.name);
    return names;
}

}  // namespace

TEST_CASE("the passes of Blender's multilayer files are known", "[renderer_channels]") {
    const Names channels = names_in("blender_guide.exr");  // as Blender 5.0 wrote it: a part each
    CHECK(found(Plane::position, channels) == layer("ViewLayer.Position", "XYZ"));
    CHECK(found(Plane::normal, channels) == layer("ViewLayer.Normal", "XYZ"));
    CHECK(found(Plane::albedo, channels) == layer("ViewLayer.Diffuse Color", "RGB"));
    CHECK(found(Plane::emission, channels) == layer("ViewLayer.Emission", "RGB"));
    CHECK(found(Plane::distance, channels) == layer("ViewLayer.Depth", "Z"));
    CHECK(found(Plane::id, channels) == layer("ViewLayer.Object Index", "X"));
    CHECK(found(Plane::radiance, channels) == layer("ViewLayer.Combined", "RGB"));
}

TEST_CASE("the names of Blender 4 are known too", "[renderer_channels]") {
    const std::string view = "View Layer.";
    const Names channels =
        all_of({layer(view + "Combined", "ABGR"), layer(view + "Depth", "Z"),
                layer(view + "Normal", "XYZ"), layer(view + "Denoising Normal", "XYZ"),
                layer(view + "DiffCol", "BGR"), layer(view + "Denoising Albedo", "BGR"),
                layer(view + "Emit", "BGR"), layer(view + "IndexOB", "X")});
    CHECK(found(Plane::radiance, channels) == layer(view + "Combined", "RGB"));
    CHECK(found(Plane::normal, channels) == layer(view + "Normal", "XYZ"));
    CHECK(found(Plane::albedo, channels) == layer(view + "DiffCol", "RGB"));
    CHECK(found(Plane::emission, channels) == layer(view + "Emit", "RGB"));
    CHECK(found(Plane::distance, channels) == layer(view + "Depth", "Z"));
    CHECK(found(Plane::id, channels) == layer(view + "IndexOB", "X"));
    CHECK(found(Plane::position, channels).empty());
}

TEST_CASE("the values of Mitsuba's aov integrator are known by usual names",
          "[renderer_channels]") {
    const Names channels = names_in("mitsuba_guide.exr");  // as Mitsuba 3.9 wrote it
    CHECK(found(Plane::position, channels) == layer("position", "XYZ"));
    CHECK(found(Plane::normal, channels) == layer("nn", "XYZ"));
    CHECK(found(Plane::albedo, channels) == layer("albedo", "RGB"));
    CHECK(found(Plane::emission, channels) == layer("emission", "RGB"));
    CHECK(found(Plane::distance, channels) == layer("dd.y", "T"));
    CHECK(found(Plane::id, channels) == layer("shape_index", "I"));
}

TEST_CASE("pbrt's gbuffer film is known, by its old names too", "[renderer_channels]") {
    Names channels = all_of({{"R", "G", "B"},
                             layer("Albedo", "RGB"),
                             layer("P", "XYZ"),
                             {"u", "v", "dzdx", "dzdy"},
                             layer("N", "XYZ"),
                             layer("Ns", "XYZ"),
                             layer("Variance", "RGB"),
                             layer("RelativeVariance", "RGB")});
    CHECK(found(Plane::radiance, channels) == Names{"R", "G", "B"});
    CHECK(found(Plane::albedo, channels) == layer("Albedo", "RGB"));
    CHECK(found(Plane::position, channels) == layer("P", "XYZ"));
    CHECK(found(Plane::normal, channels) == layer("N", "XYZ"));
    CHECK(found(Plane::distance, channels).empty());
    CHECK(found(Plane::id, channels).empty());
    channels = {"R",  "G",  "B",    "Albedo.R", "Albedo.G", "Albedo.B", "Px",  "Py", "Pz",
                "Nx", "Ny", "dzdx", "dzdy",     "Nz",       "Nsx",      "Nsy", "Nsz"};
    CHECK(found(Plane::position, channels) == Names{"Px", "Py", "Pz"});
    CHECK(found(Plane::normal, channels) == Names{"Nx", "Ny", "Nz"});
}

TEST_CASE("our own names are known", "[renderer_channels]") {
    Names channels;
    for (const PlaneInfo& plane : all_planes()) {
        for (std::size_t c = 0; c < plane.channel_count(); ++c)
            channels.emplace_back(plane.channels[c]);
    }
    for (const PlaneInfo& plane : all_planes()) {
        CAPTURE(plane.name);
        const Names names = found(plane.plane, channels);
        const bool is_sampling =  // of all samples, where a guide is of one hit
            plane.plane == Plane::count || plane.plane == Plane::variance ||
            plane.plane == Plane::albedo_mean || plane.plane == Plane::normal_mean;
        if (is_sampling) {
            CHECK(names.empty());
            continue;
        }
        REQUIRE(names.size() == plane.channel_count());
        for (std::size_t c = 0; c < names.size(); ++c) CHECK(names[c] == plane.channels[c]);
    }
}

TEST_CASE("two layers of one kind are an error that says how to choose", "[renderer_channels]") {
    const Names channels = all_of({layer("Day.Normal", "XYZ"), layer("Night.Normal", "XYZ")});
    const Error error = error_of([&] { (void)found(Plane::normal, channels); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK(std::string(error.what()) ==
          "a.exr: found normal in channels Day.Normal.X, Day.Normal.Y, Day.Normal.Z and in "
          "Night.Normal.X, Night.Normal.Y, Night.Normal.Z, allowed: --channel normal=... to say "
          "which");
}

TEST_CASE("other names are given by a flag", "[renderer_channels]") {
    ChannelNames names;
    add_channel_names("normal=foo.N.X,foo.N.Y,foo.N.Z", names);
    add_channel_names("id=mask", names);
    CHECK(names.at(Plane::normal) == layer("foo.N", "XYZ"));
    CHECK(names.at(Plane::id) == Names{"mask"});
    const auto fault = [&](const char* text) {
        const Error error = error_of([&] { add_channel_names(text, names); });
        CHECK(error.code() == ExitCode::usage);
        return std::string(error.what());
    };
    CHECK(fault("normal=a,b") ==
          "command line: --channel: found \"normal=a,b\", allowed: the names of 3 channels of "
          "normal");
    CHECK_THAT(fault("normals=a,b,c"),
               Catch::Matchers::Contains("PLANE one of radiance, emission, albedo, position"));
    CHECK_THAT(fault("normal"), Catch::Matchers::Contains("PLANE=X,Y,Z"));
    CHECK_THAT(fault("id="), Catch::Matchers::Contains("the names of 1 channels of id"));
}

TEST_CASE("planes are read from any part, by the names that are given", "[renderer_channels]") {
    const TempDir dir;
    const Names channels{"R", "G", "B", "foo.N.X", "foo.N.Y", "foo.N.Z", "mask"};
    write_foreign<float>(dir.path("a.exr"), make_spec({1, 1}, channels, OIIO::TypeDesc::FLOAT),
                         {1, 2, 3, 0, 0, 1, 4.9999f});
    ChannelNames names;
    add_channel_names("normal=foo.N.X,foo.N.Y,foo.N.Z", names);
    add_channel_names("id=mask", names);
    const Planes wanted{Plane::radiance, Plane::normal, Plane::id, Plane::albedo};
    const RendererFrame file = load_renderer_frame(dir.path("a.exr"), wanted, names);
    CHECK(file.frame.radiance(0, 0) == glm::vec3(1, 2, 3));
    CHECK(file.frame.normal_world(0, 0) == glm::vec3(0, 0, 1));
    CHECK(file.frame.object_id(0, 0) == 5);
    CHECK(file.frame.albedo.empty());
    CHECK(file.half_planes == Planes{});
    add_channel_names("id=foo.id", names);
    const Error error =
        error_of([&] { (void)load_renderer_frame(dir.path("a.exr"), {Plane::id}, names); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK_THAT(error.what(), Catch::Matchers::Contains("found no channel foo.id"));
}

TEST_CASE("a guide needs no radiance, and half floats are told", "[renderer_channels]") {
    const TempDir dir;
    write_foreign<std::uint16_t>(dir.path("a.exr"),
                                 make_spec({1, 1}, layer("Position", "XYZ"), OIIO::TypeDesc::HALF),
                                 {0x3C00, 0x4000, 0x4200});  // 1, 2, 3
    const RendererFrame file = load_renderer_frame(dir.path("a.exr"), {Plane::position});
    CHECK(file.frame.radiance.empty());
    CHECK(file.frame.position_world(0, 0) == glm::vec3(1, 2, 3));
    CHECK(file.half_planes == Planes{Plane::position});
    const Error error =
        error_of([&] { (void)load_renderer_frame(dir.path("a.exr"), {Plane::radiance}); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK_THAT(error.what(), Catch::Matchers::Contains("allowed: R, G, B or Y among them"));
}
