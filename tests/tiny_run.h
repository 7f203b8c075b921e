// SPDX-License-Identifier: Apache-2.0
//
// A matrix of the Cornell box in a directory of its own, small enough to run in a test.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/image_io.h"
#include "eval/matrix.h"
#include "eval/reference_store.h"
#include "eval/run_directory.h"
#include "eval/run_matrix.h"
#include "tests/temp_dir.h"

namespace vecino {

struct TinyMatrix {
    TempDir temp;
    std::string directory = temp.path("run");
    nlohmann::json json = {{"name", "tiny"},
                           {"axes",
                            {{"scene", "box.json"},
                             {"scheme", {"nearest", "mean"}},
                             {"reduction", 2},
                             {"seed", {1, 2}}}},
                           {"fixed", {{"size", {16, 12}}, {"spp", 8}}},
                           {"reference", {{"spp", 128}, {"seed", 1000}}}};

    TinyMatrix() { copy_scene("box"); }

    /// The Cornell box under another name.
    void copy_scene(const std::string& name) const {
        temp.write(name + ".json",
                   read_file(std::string(VECINO_SOURCE_DIR) + "/scenes/cornell.json"));
    }
    [[nodiscard]] Matrix load() const { return load_matrix(temp.write("tiny.json", json.dump())); }
    RunSummary run(const RunOptions& options = {}) const {
        return run_matrix(load(), directory, options);
    }

    [[nodiscard]] std::map<std::string, nlohmann::json> rows() const {
        return RunDirectory::open(directory).rows();
    }
    [[nodiscard]] std::vector<nlohmann::json> row_list() const {
        std::vector<nlohmann::json> list;
        for (const auto& [name, row] : rows()) list.push_back(row);
        return list;
    }
    void write_rows(const std::map<std::string, nlohmann::json>& rows) const {
        std::string lines;
        for (const auto& [name, row] : rows) lines += row.dump() + "\n";
        temp.write("run/results.jsonl", lines);
    }
    [[nodiscard]] std::string image_file(const std::string& cell) const {
        return directory + "/cells/" + cell + "/image.exr";
    }
    [[nodiscard]] Frame reference(const nlohmann::json& row) const {
        return load_frame(directory + "/" + row["reference_file"].get<std::string>() + ".exr");
    }
};

}  // namespace vecino
