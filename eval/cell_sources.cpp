// SPDX-License-Identifier: Apache-2.0
#include "eval/cell_sources.h"

#include <filesystem>

#include "core/error.h"
#include "core/files.h"
#include "eval/reference_store.h"

namespace vecino {
namespace {

namespace fs = std::filesystem;

std::string hash_of(const std::string& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return "no file";
    try {
        return text_hash(read_file(path));
    } catch (const Error&) {
        return "unreadable";
    }
}

/// A command's arguments may name its inputs, and its script.
std::string command_hash(const Matrix& matrix, const Cell& cell) {
    Placeholders values = placeholders_of(cell.scene, cell.settings);
    values["input"] = values["output"] = "";
    std::string text;
    for (const std::string& argument : cell.image->command) {
        const fs::path path = fs::path(folder_of(matrix)) / fill_template(argument, values);
        std::error_code error;
        if (fs::is_regular_file(path, error)) text += hash_of(path.string());
    }
    return text.empty() ? text : text_hash(text);
}

}  // namespace

std::string scene_hash(const std::string& path, const Scene& scene) {
    std::string hash = text_hash(read_file(path));
    for (const Material& material : scene.materials) {
        if (material.albedo_texture != nullptr)
            hash = text_hash(hash + text_hash(read_file(material.albedo_texture->file)));
    }
    return hash;
}

std::string reference_path(const Matrix& matrix, const Cell& cell) {
    return sourced_path(matrix, matrix.reference_source->file,
                        placeholders_of(cell.scene, cell.settings));
}

std::string image_hash(const Matrix& matrix, const Cell& cell) {
    if (cell.kind != CellKind::image) return "";
    if (cell.image->file.empty()) return command_hash(matrix, cell);
    return hash_of(
        sourced_path(matrix, cell.image->file, placeholders_of(cell.scene, cell.settings)));
}

std::string reference_hash(const Matrix& matrix, const Cell& cell) {
    return matrix.reference_source == nullptr ? "" : hash_of(reference_path(matrix, cell));
}

}  // namespace vecino
