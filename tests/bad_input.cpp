// SPDX-License-Identifier: Apache-2.0
#include "tests/bad_input.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <sstream>
#include <vector>

#include "eval/commands.h"
#include "tests/catch.h"

namespace vecino::test {
namespace {

namespace fs = std::filesystem;

/// Keeps what is written to a file descriptor, for as long as it lives.
class Capture {
  public:
    explicit Capture(int descriptor) : descriptor_(descriptor), saved_(::dup(descriptor)) {
        flush();
        ::dup2(::fileno(file_), descriptor_);
    }
    ~Capture() {
        flush();
        ::dup2(saved_, descriptor_);
        ::close(saved_);
        std::fclose(file_);
    }
    Capture(const Capture&) = delete;
    Capture& operator=(const Capture&) = delete;

    [[nodiscard]] std::string text() const {
        flush();
        std::rewind(file_);
        std::string text;
        for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_))
            text += static_cast<char>(c);
        return text;
    }

  private:
    static void flush() {
        std::cout.flush();
        std::fflush(nullptr);
    }

    std::FILE* file_ = std::tmpfile();
    int descriptor_;
    int saved_;
};

class CurrentFolder {
  public:
    explicit CurrentFolder(const fs::path& folder) { fs::current_path(folder); }
    ~CurrentFolder() { fs::current_path(before_); }
    CurrentFolder(const CurrentFolder&) = delete;
    CurrentFolder& operator=(const CurrentFolder&) = delete;

  private:
    fs::path before_ = fs::current_path();
};

struct Outcome {
    int code = -1;
    std::string out, err;
};

Outcome call(const std::string& line) {
    std::vector<std::string> words{"vecino"};
    std::istringstream stream(line);
    for (std::string word; stream >> std::quoted(word);) words.push_back(word);
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    const Capture out(STDOUT_FILENO);
    const Capture err(STDERR_FILENO);
    const int code = run_program(static_cast<int>(arguments.size()), arguments.data());
    return {code, out.text(), err.text()};
}

/// Every file below a folder with its bytes, and every folder.
std::map<std::string, std::string> contents(const TempDir& dir) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(dir.path("."))) {
        const std::string name = fs::relative(entry.path(), dir.path(".")).string();
        files[name] = entry.is_directory() ? "a folder" : dir.read(name);
    }
    return files;
}

}  // namespace

void check_mistakes(const TempDir& dir, std::span<const Mistake> mistakes) {
    const CurrentFolder current(dir.path("."));
    const auto before = contents(dir);
    for (const Mistake& mistake : mistakes) {
        const Outcome outcome = call(mistake.line);
        CAPTURE(mistake.name, mistake.line, mistake.message, outcome.err);
        CHECK(outcome.code == mistake.code);
        CHECK(outcome.out.empty());
        const bool is_error =
            outcome.err.starts_with("vecino: ") || outcome.err.starts_with("error: ");
        CHECK(is_error);
        CHECK(outcome.err.find(mistake.message) != std::string::npos);
        CHECK(std::ranges::count(outcome.err, '\n') == 1);
        const bool nothing_changed = contents(dir) == before;
        CHECK(nothing_changed);
    }
}

void check_success(const TempDir& dir, const std::string& line) {
    const CurrentFolder current(dir.path("."));
    const Outcome outcome = call(line);
    CAPTURE(line, outcome.err);
    CHECK(outcome.code == 0);
}

}  // namespace vecino::test
