// SPDX-License-Identifier: Apache-2.0
//
// A run directory on disk:
//   run.json  results.jsonl  results.csv  report.html
//   statistics.json    noise and bias of each group     equal_time.json  measured budgets
//   reproduction.json  verdicts, if the matrix holds claims
//   failures.json      numbers and verdicts, if it names failures
//   references/SCENE-HASH.exr .png
//   cells/CELL/image.exr image.png error.png error_signed.png, and cell.vti if asked for
//   planes/cells/CELL.js  planes/references/SCENE-HASH.js   float values for the report's viewer
// One process at a time may write to it. results.jsonl grows by whole lines, so that a killed run
// loses no finished cell.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace vecino {

class RunDirectory {
  public:
    /// Opens a directory for writing; makes it if it is not there. Throws Error(file) when it
    /// cannot, or when another process holds it.
    static RunDirectory create(const std::string& path);
    /// Opens an existing one for reading. Throws Error(file) if there is no results.jsonl.
    static RunDirectory open(const std::string& path);

    /// A directory that may not be there yet, to look at its rows. Never throws, never writes.
    static RunDirectory peek(const std::string& path) { return RunDirectory(path); }

    ~RunDirectory();
    RunDirectory(RunDirectory&& other) noexcept;
    RunDirectory(const RunDirectory&) = delete;
    RunDirectory& operator=(const RunDirectory&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::string file(const std::string& relative) const {
        return path_ + "/" + relative;
    }
    /// The path of a file below a folder of the directory; makes the folder.
    [[nodiscard]] std::string file_in(const std::string& folder, const std::string& name) const;

    /// Rows of results.jsonl, the last one of each cell. A half-written last line is left out.
    [[nodiscard]] std::map<std::string, nlohmann::json> rows() const;
    void append(const nlohmann::json& row) const;

    void write_run(const nlohmann::json& run) const;  ///< run.json
    /// Writes results.jsonl anew (one row per cell, in this order) and results.csv.
    void write_results(const std::vector<nlohmann::json>& rows) const;

  private:
    explicit RunDirectory(std::string path) : path_(std::move(path)) {}

    std::string path_;
    int lock_ = -1;
};

/// Replaces a text file whole or not at all. Throws Error(file).
void write_text_file(const std::string& path, const std::string& text);

}  // namespace vecino
