// SPDX-License-Identifier: Apache-2.0
//
// Files as bytes. A file is read whole or refused with the system's reason; it is written whole or
// not at all: under a temporary name beside it, then renamed.
#pragma once

#include <cstdio>
#include <string>

#include "core/error.h"

namespace vecino {

/// A file that cannot be written, as on a full disk: whoever reads other files in vain may go on,
/// but not from here.
class WriteError : public Error {
  public:
    explicit WriteError(const std::string& message) : Error(ExitCode::file, message) {}
};

/// The reason where the system gives none.
constexpr const char* kWriteFailed = "a write failed, as on a full disk";

/// Throws Error(file): "PATH: cannot be read: REASON", on one line.
[[noreturn]] void cannot_read(const std::string& path, const std::string& reason);
/// The same with WriteError.
[[noreturn]] void cannot_write(const std::string& path, const std::string& reason);

/// Line breaks and control characters become spaces.
std::string one_line(std::string text);

/// Throws Error(file) if there is no such file, or it is a directory or not ours to read.
void require_readable(const std::string& path);

/// Throws Error(file) if no file can be made in the place of this one. For use before work whose
/// result goes there.
void require_writable(const std::string& path);

/// All bytes of a file. Throws Error(file).
std::string read_file(const std::string& path);

/// The first 1 MiB of a file, or all of it: the header of any image. Throws Error(file).
std::string read_beginning(const std::string& path);

/// A file name unlike any other of this process or another. Short, so that a target of any legal
/// length has one.
std::string temporary_name(const std::string& extension);

/// Removes, at any depth of a folder, files of such names whose process is gone: killed, it could
/// not.
void remove_abandoned(const std::string& folder);

/// A new, empty file in the directory of a target, with the target's extension. Whatever happens
/// before replace_target(), the target stays as it was and nothing stays behind.
class TemporaryFile {
  public:
    /// Throws Error(file), naming the target and the reason, if no file can be made there.
    explicit TemporaryFile(const std::string& target);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::FILE* stream() const { return stream_; }  ///< to write to, not to close

    /// Takes the target's place. Throws Error(file) if any write to the stream failed, as on a full
    /// disk.
    void replace_target();

  private:
    std::string target_;
    std::string path_;
    std::FILE* stream_ = nullptr;
};

}  // namespace vecino
