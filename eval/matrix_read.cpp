// SPDX-License-Identifier: Apache-2.0
//
// Reading of matrix files; their expansion into cells is in matrix.cpp.
#include <algorithm>
#include <filesystem>
#include <vector>

#include "eval/axes.h"
#include "eval/gate_classes.h"
#include "eval/matrix.h"
#include "eval/metrics.h"
#include "eval/render_options.h"
#include "eval/reproduction_spec.h"

namespace vecino {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view kReferenceKeys[] = {"spp", "light_sampling", "sampler", "seed"};
constexpr std::string_view kParts[] = {"axes",    "fixed",     "images",      "reference",
                                       "measure", "stability", "reproduction"};

RenderSettings read_reference(const JsonValue& json) {
    RenderSettings settings;
    for (const RenderOption& row : render_options()) {
        const bool known = std::ranges::find(kReferenceKeys, row.name) != std::end(kReferenceKeys);
        if (known && json.has(row.name)) row.set(settings, json.at(row.name));
    }
    return settings;
}

void read_reference(const JsonValue& json, Matrix& matrix) {
    std::vector<std::string_view> keys(std::begin(kReferenceKeys), std::end(kReferenceKeys));
    keys.insert(keys.end(), {"file", "channels"});
    json.require_keys(keys);
    if (json.has("file")) {
        matrix.reference_source = std::make_shared<ImageSource>(read_reference_source(json));
    } else {
        if (json.has("channels"))
            json.at("channels").fail("\"channels\" of a render", "them beside \"file\"");
        matrix.reference = read_reference(json);
    }
}

void read_images(const JsonValue& json, Matrix& matrix) {
    for (const auto& [name, value] : json.members()) {
        const bool is_taken =
            name == "path" || name == "blocky_ceiling" ||
            std::ranges::find(all_schemes(), name, &Scheme::name) != all_schemes().end();
        if (is_taken || name.empty() || name.find_first_of("/.") != std::string::npos)
            value.fail("the name \"" + name + "\"",
                       "names of no method of vecino's, without dots and slashes");
        matrix.images[name] = std::make_shared<ImageSource>(read_image_source(name, value));
    }
}

/// The images that cells name are there.
void require_images(const JsonValue& cells, const Matrix& matrix) {
    if (!cells.has("image")) return;
    for (const JsonValue& each : listed("image", cells.at("image"))) {
        if (matrix.images.contains(each.string())) continue;
        std::string names;
        for (const auto& [name, source] : matrix.images)
            names += (names.empty() ? "" : ", ") + name;
        each.fail(names.empty() ? "a key of \"images\", which is not there" : names);
    }
}

void read_measure(const JsonValue& json, Matrix& matrix) {
    json.require_keys({"repeat", "metrics"});
    if (json.has("repeat")) matrix.repeat = json.at("repeat").integer(1, 1000);
    if (!json.has("metrics")) return;
    const std::vector<std::string> allowed = metrics_on_request();
    for (const JsonValue& name : json.at("metrics").elements()) {
        if (std::ranges::find(allowed, name.string()) == allowed.end())
            name.fail(join(std::vector<std::string_view>(allowed.begin(), allowed.end())));
        matrix.metrics.push_back(name.string());
    }
}

/// A file shows what one camera sees.
void read_stability(const JsonValue& json, Matrix& matrix) {
    matrix.stability = read_stability(json);
    if (matrix.reference_source == nullptr) return;
    if (json.has("shifts") && !matrix.stability->shifts.empty())
        json.at("shifts").fail("shifts of a camera whose reference is a file", "no shifts");
    matrix.stability->shifts.clear();
}

void read_failures(const JsonValue& json, Matrix& matrix) {
    for (const JsonValue& each : json.elements()) {
        matrix.failures.push_back(read_failure(each));
        const FailureCase& failure = matrix.failures.back();
        if (failure.scene.empty()) each.fail("no key \"scene\"", "\"scene\" in an object");
        const auto same = [&](const FailureCase& other) {
            return stem(other.scene) == stem(failure.scene) || other.title == failure.title;
        };
        if (std::ranges::count_if(matrix.failures, same) > 1)
            each.fail("a scene or title that stands here twice", "every one once");
    }
}

void check_fixed(const JsonValue& json) {
    json.require_keys(cell_keys());
    for (const auto& [key, value] : json.members()) require_cell_value(key, value);
    require_one_kind(json);
}

void check_cells(const JsonValue& json, const Matrix& matrix) {
    const auto check_axes = [&](const JsonValue& axes) {
        (void)read_axes(axes);
        require_images(axes, matrix);
    };
    if (json.has("fixed")) {
        check_fixed(json.at("fixed"));
        require_images(json.at("fixed"), matrix);
    }
    check_axes(json.at("axes"));
    for (const char* key : {"exclude", "include"}) {
        if (!json.has(key)) continue;
        for (const JsonValue& each : json.at(key).elements()) check_axes(each);
    }
}

/// Scene paths are relative to the file that they stand in: once they stand in another one, they
/// have to lead to the same place, and be spelled as one would there, so that excludes match them.
void move_scenes(Json& json, const fs::path& from, const fs::path& to) {
    if (json.is_array()) {
        for (Json& each : json) move_scenes(each, from, to);
    } else if (json.is_object() && json.contains("scene")) {
        const auto moved = [&](const Json& scene) {
            const fs::path file = (from / scene.get<std::string>()).lexically_normal();
            return file.lexically_proximate(to).generic_string();
        };
        Json& scene = json["scene"];
        if (!scene.is_array()) scene = moved(scene);
        if (!scene.is_array()) return;
        for (Json& each : scene) each = moved(each);
    }
}

constexpr const char* kWithScenes[] = {"axes", "fixed", "exclude", "include", "failures"};

/// One spelling of each path, by which excludes and the needs of failures find it.
void spell_scenes_alike(Matrix& matrix) {
    const fs::path folder = fs::path(matrix.file).parent_path().lexically_normal();
    for (const char* key : kWithScenes)
        if (matrix.document.contains(key)) move_scenes(matrix.document[key], folder, folder);
}

}  // namespace

Matrix matrix_of(Json document, const std::string& file) {
    Matrix matrix;
    matrix.file = file;
    matrix.document = std::move(document);
    const JsonValue json(matrix.document, file);
    json.require_keys({"$schema", "extends", "name", "axes", "exclude", "include", "fixed",
                       "failures", "images", "reference", "measure", "stability", "gates",
                       "reproduction"});
    if (json.has("$schema")) (void)json.at("$schema").string();
    matrix.name = json.at("name").string();
    read_reference(json.at("reference"), matrix);
    if (json.has("images")) read_images(json.at("images"), matrix);
    if (json.has("measure")) read_measure(json.at("measure"), matrix);
    if (json.has("stability")) read_stability(json.at("stability"), matrix);
    if (json.has("failures")) read_failures(json.at("failures"), matrix);
    check_cells(json, matrix);
    (void)read_gate_classes(json);
    if (json.has("reproduction")) (void)read_reproduction(json);
    spell_scenes_alike(matrix);
    return matrix;
}

namespace {

/// The same for files of images: {NAME} in them stays as it is.
void move_file(Json& json, const fs::path& from, const fs::path& to) {
    if (!json.is_object() || !json.contains("file")) return;
    const fs::path file = (from / json["file"].get<std::string>()).lexically_normal();
    json["file"] = file.lexically_proximate(to).generic_string();
}

void move_files(Json& base, const fs::path& from, const fs::path& to) {
    for (const char* key : kWithScenes)
        if (base.contains(key)) move_scenes(base[key], from, to);
    if (base.contains("reference")) move_file(base["reference"], from, to);
    if (!base.contains("images")) return;
    for (Json& image : base["images"]) move_file(image, from, to);
}

/// What the file says, over what it extends: the parts of kParts key by key, the rest as a whole.
Json merged(Json base, const Json& own) {
    for (const auto& [key, value] : own.items()) {
        const auto is_file = [](const Json& json) { return json.contains("file"); };
        const bool is_other_kind =
            key == "reference" && base.contains(key) && is_file(value) != is_file(base[key]);
        const bool is_part = std::ranges::find(kParts, key) != std::end(kParts) && !is_other_kind;
        if (is_part && base.contains(key) && value.is_object()) {
            base[key].update(value);
        } else if (key != "extends") {
            base[key] = value;
        }
    }
    return base;
}

Matrix load(const std::string& path, std::vector<std::string>& opened) {
    Json own = parse_json_file(path);
    const JsonValue json(own, path);
    if (json.has("failures")) own["failures"] = embedded_failures(json.at("failures"));
    if (!own.is_object() || !json.has("extends")) return matrix_of(own, path);
    (void)json.at("name").string();
    const fs::path folder = fs::path(path).parent_path().lexically_normal();
    const std::string base_path =
        (folder / json.at("extends").string()).lexically_normal().string();
    opened.push_back(fs::path(path).lexically_normal().string());
    if (std::ranges::find(opened, base_path) != opened.end())
        json.at("extends").fail("a matrix that does not lead back to this one");
    Json base = load(base_path, opened).document;
    move_files(base, fs::path(base_path).parent_path(), folder);
    return matrix_of(merged(std::move(base), own), path);
}

}  // namespace

Matrix load_matrix(const std::string& path) {
    std::vector<std::string> opened;
    return load(path, opened);
}

}  // namespace vecino
