// SPDX-License-Identifier: Apache-2.0
#include "eval/run_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "core/files.h"
#include "eval/csv.h"

namespace vecino {
namespace {

void make_folder(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) throw WriteError(path + ": cannot make the directory: " + error.message());
}

}  // namespace

void write_text_file(const std::string& path, const std::string& text) {
    TemporaryFile file(path);
    std::ofstream stream(file.path(), std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) cannot_write(path, kWriteFailed);
    file.replace_target();
}

RunDirectory RunDirectory::create(const std::string& path) {
    make_folder(path);
    RunDirectory directory(path);
    const std::string lock = directory.file(".lock");
    directory.lock_ = ::open(lock.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
    if (directory.lock_ < 0) cannot_write(lock, std::strerror(errno));
    if (flock(directory.lock_, LOCK_EX | LOCK_NB) != 0) {
        throw Error(ExitCode::file, path + ": another run is writing to this directory");
    }
    remove_abandoned(path);
    require_writable(directory.file("results.jsonl"));
    return directory;
}

RunDirectory RunDirectory::open(const std::string& path) {
    RunDirectory directory(path);
    (void)read_file(directory.file("results.jsonl"));
    return directory;
}

RunDirectory::~RunDirectory() {
    if (lock_ >= 0) ::close(lock_);
}

RunDirectory::RunDirectory(RunDirectory&& other) noexcept
    : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}

std::string RunDirectory::file_in(const std::string& folder, const std::string& name) const {
    make_folder(file(folder));
    return file(folder + "/" + name);
}

std::map<std::string, nlohmann::json> RunDirectory::rows() const {
    std::map<std::string, nlohmann::json> rows;
    std::ifstream stream(file("results.jsonl"));
    std::string line;
    while (std::getline(stream, line)) {
        const nlohmann::json row = nlohmann::json::parse(line, nullptr, false);
        if (!row.is_object() || !row.value("cell", nlohmann::json()).is_string()) continue;
        rows[row["cell"].get<std::string>()] = row;
    }
    return rows;
}

void RunDirectory::append(const nlohmann::json& row) const {
    // A killed run may have left half a line: end it, so that this one stands alone.
    const std::string path = file("results.jsonl");
    bool ends_line = true;
    if (std::ifstream before(path, std::ios::binary | std::ios::ate);
        before && before.tellg() > 0) {
        before.seekg(-1, std::ios::end);
        ends_line = before.get() == '\n';
    }
    std::ofstream stream(path, std::ios::app | std::ios::binary);
    stream << (ends_line ? "" : "\n") << row.dump() << "\n";
    stream.close();
    if (!stream) cannot_write(path, kWriteFailed);
}

void RunDirectory::write_run(const nlohmann::json& run) const {
    write_text_file(file("run.json"), run.dump(2) + "\n");
}

void RunDirectory::write_results(const std::vector<nlohmann::json>& rows) const {
    std::string lines;
    for (const nlohmann::json& row : rows) lines += row.dump() + "\n";
    write_text_file(file("results.jsonl"), lines);
    write_text_file(file("results.csv"), csv_text(rows, "cell"));
}

}  // namespace vecino
