// SPDX-License-Identifier: Apache-2.0
#include "core/files.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

namespace vecino {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

/// The system opens directories as if they were files, and only then refuses to read them.
bool is_directory(const std::string& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

File open_to_read(const std::string& path) {
    if (is_directory(path)) cannot_read(path, "it is a directory");
    File file(std::fopen(path.c_str(), "rb"));
    if (!file) cannot_read(path, std::strerror(errno));
    return file;
}

constexpr std::string_view kTemporary = ".vecino.";

/// The process that a file's name says it is a temporary file of; 0 for any other name.
pid_t owner_of(std::string_view name) {
    if (!name.starts_with(kTemporary) || name.find(".tmp") == name.npos) return 0;
    name.remove_prefix(kTemporary.size());
    pid_t owner = 0;
    std::from_chars(name.data(), name.data() + name.size(), owner);
    return owner;
}

bool is_running(pid_t process) {
    return ::kill(process, 0) == 0 || errno != ESRCH;
}

}  // namespace

void cannot_read(const std::string& path, const std::string& reason) {
    throw Error(ExitCode::file, one_line(path + ": cannot be read: " + reason));
}

void cannot_write(const std::string& path, const std::string& reason) {
    throw WriteError(one_line(path + ": cannot be written: " + reason));
}

std::string one_line(std::string text) {
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < ' ' || c == 0x7F; }, ' ');
    return text;
}

void require_readable(const std::string& path) {
    open_to_read(path);
}

void require_writable(const std::string& path) {
    const TemporaryFile probe(path);
}

std::string read_file(const std::string& path) {
    const File file = open_to_read(path);
    std::string bytes;
    char block[1 << 16];
    errno = 0;
    while (const std::size_t count = std::fread(block, 1, sizeof block, file.get())) {
        bytes.append(block, count);
    }
    if (std::ferror(file.get()) != 0) cannot_read(path, std::strerror(errno));
    return bytes;
}

std::string read_beginning(const std::string& path) {
    const File file = open_to_read(path);
    std::string bytes(std::size_t{1} << 20, '\0');
    bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
    return bytes;
}

std::string temporary_name(const std::string& extension) {
    static std::atomic<unsigned> count = 0;
    return std::string(kTemporary) + std::to_string(::getpid()) + "." + std::to_string(count++) +
           ".tmp" + extension;
}

void remove_abandoned(const std::string& folder) {
    std::error_code ignored;
    std::vector<fs::path> abandoned;
    for (fs::recursive_directory_iterator entry(folder, ignored), end; entry != end;
         entry.increment(ignored)) {
        const pid_t owner = owner_of(entry->path().filename().string());
        if (owner > 0 && !is_running(owner)) abandoned.push_back(entry->path());
    }
    for (const fs::path& path : abandoned) fs::remove(path, ignored);
}

TemporaryFile::TemporaryFile(const std::string& target) : target_(target) {
    if (is_directory(target)) cannot_write(target, "it is a directory");
    const fs::path folder = fs::path(target).parent_path();
    const std::string path =
        (folder / temporary_name(fs::path(target).extension().string())).string();
    stream_ = std::fopen(path.c_str(), "w+b");
    if (stream_ == nullptr) {
        const std::string reason = std::strerror(errno);
        cannot_write(target, folder.empty() ? reason : folder.string() + ": " + reason);
    }
    path_ = path;
}

TemporaryFile::~TemporaryFile() {
    if (stream_ != nullptr) std::fclose(stream_);
    std::error_code ignored;
    if (!path_.empty()) fs::remove(path_, ignored);
}

void TemporaryFile::replace_target() {
    errno = 0;
    const bool wrote = std::ferror(stream_) == 0;  // all so far
    const bool whole = std::fclose(std::exchange(stream_, nullptr)) == 0 && wrote;
    if (!whole) {
        cannot_write(target_, errno != 0 ? std::strerror(errno) : kWriteFailed);
    }
    std::error_code error;
    fs::rename(path_, target_, error);
    if (error) cannot_write(target_, error.message());
    path_.clear();
}

}  // namespace vecino
