// SPDX-License-Identifier: Apache-2.0
//
// Reads any bytes as a matrix and expands it. Two documents in an array are a matrix that extends
// another one.
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "core/json_read.h"
#include "eval/matrix.h"
#include "eval/run_directory.h"
#include "tests/fuzz/contract.h"
#include "tests/temp_dir.h"

using namespace vecino;
using fuzz::require;

namespace {

/// Cells have folders of these names, and rows of these keys.
void check_names(const std::vector<Cell>& cells) {
    std::set<std::string> names;
    for (const Cell& cell : cells) {
        require(names.insert(cell.name).second, "two cells named " + cell.name);
        require(cell.name.find('/') == std::string::npos, "a slash in the cell " + cell.name);
        require(cell.name.size() <= 255, "a cell's name too long for a folder: " + cell.name);
        require(cell.name.find('\0') == std::string::npos, "a cell's name with a zero byte");
    }
}

void check(const Cell& cell) {
    require(!cell.scene.empty(), "a cell without a scene");
    require((cell.kind == CellKind::scheme) == (cell.scheme != nullptr), "scheme of a cell");
    require((cell.kind == CellKind::image) == (cell.image != nullptr), "image of a cell");
    require(cell.settings.spp >= 1 && cell.settings.reduction >= 1, "settings of a cell");
    require(cell.parameters.window % 2 == 1, "window of a cell");
    (void)cell.parameters_json().dump();
    (void)cell.samples_ratio();
}

nlohmann::json parsed(const std::string& text) {
    return parse_json_text(text, "a.json");
}

Matrix load_extended(const nlohmann::json& documents) {
    static const TempDir dir;
    dir.write("base.json", documents[0].dump());
    return load_matrix(dir.write("own.json", documents[1].dump()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    Matrix matrix;
    const auto read = [&] {
        const nlohmann::json document = parsed(text);
        const bool extends = document.is_array() && document.size() == 2;
        matrix = extends ? load_extended(document) : matrix_of(document, "a.json");
    };
    if (!fuzz::gives_result(read)) return 0;
    std::vector<Cell> cells;
    if (!fuzz::gives_result([&] { cells = expand(matrix); })) return 0;
    check_names(cells);
    for (const Cell& cell : cells) check(cell);
    return 0;
}
