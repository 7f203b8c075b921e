// SPDX-License-Identifier: Apache-2.0
//
// Files that cannot be read or written: the code, the words, and what is left on disk.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <limits>

#include "core/files.h"
#include "core/image_io.h"
#include "core/planes.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/temp_dir.h"
#include "tests/test_images.h"

using namespace vecino;
using FileNames = std::set<std::string>;

namespace {

constexpr const char* kEveryFormat[] = {"a.exr", "a.hdr", "a.tif", "a.tiff", "a.png", "a.bmp"};

/// No file of this process grows beyond a size: a full disk for one test.
class DiskQuota {
  public:
    explicit DiskQuota(std::size_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &old_);
        rlimit limit = old_;
        limit.rlim_cur = bytes;
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~DiskQuota() {
        ::setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, old_handler_);
    }
    DiskQuota(const DiskQuota&) = delete;
    DiskQuota& operator=(const DiskQuota&) = delete;

  private:
    rlimit old_{};
    void (*old_handler_)(int) = std::signal(SIGXFSZ, SIG_IGN);
};

/// Sends stderr into a file for as long as it lives.
class StderrTo {
  public:
    explicit StderrTo(const std::string& path) : saved_(::dup(STDERR_FILENO)) {
        const int file = ::open(path.c_str(), O_WRONLY | O_CREAT, 0600);
        ::dup2(file, STDERR_FILENO);
        ::close(file);
    }
    ~StderrTo() {
        ::dup2(saved_, STDERR_FILENO);
        ::close(saved_);
    }
    StderrTo(const StderrTo&) = delete;
    StderrTo& operator=(const StderrTo&) = delete;

  private:
    int saved_;
};

std::string file_fault(const std::string& path) {
    const Error error = error_of([&] { load_frame(path); });
    CHECK(error.code() == ExitCode::file);
    std::string message = error.what();
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.starts_with(path + ": cannot be read: "));
    return message;
}

}  // namespace

TEST_CASE("a missing image is a file error with the system's reason", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.path("missing.exr");
    CHECK(file_fault(path) == path + ": cannot be read: No such file or directory");
    CHECK(file_fault(dir.path("")) == dir.path("") + ": cannot be read: it is a directory");
}

TEST_CASE("an image cut off anywhere is a file error, and nothing else is printed", "[image_io]") {
    const std::string name = GENERATE(from_range(std::begin(kEveryFormat), std::end(kEveryFormat)));
    CAPTURE(name);
    const TempDir dir;
    save_image(make_image({120, 100}), dir.path(name));
    const std::string whole = dir.read(name);
    {
        const StderrTo silence(dir.path("stderr.txt"));
        for (const double part : {0.0, 0.001, 0.1, 0.5, 0.9, 0.999}) {
            const auto size = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
            file_fault(dir.write(name, whole.substr(0, size)));
        }
    }
    CHECK(dir.read("stderr.txt").empty());
}

TEST_CASE("a damaged PNG is a file error, and nothing else is printed", "[image_io]") {
    const TempDir dir;
    save_image(make_image({120, 100}), dir.path("a.png"));
    std::string bytes = dir.read("a.png");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    const std::string path = dir.write("a.png", bytes);
    std::string message;
    {
        const StderrTo silence(dir.path("stderr.txt"));
        message = file_fault(path);
    }
    CHECK(message.ends_with(" is damaged"));
    CHECK(dir.read("stderr.txt").empty());
}

TEST_CASE("a file that is no image is a file error, whatever its name says", "[image_io]") {
    const std::string name = GENERATE(from_range(std::begin(kEveryFormat), std::end(kEveryFormat)));
    CAPTURE(name);
    const TempDir dir;
    file_fault(dir.write(name, "This is a letter to my landlord, and not an image.\n"));
    file_fault(dir.write("notes.txt", "Nor is this.\n"));
}

TEST_CASE("a NaN bound for a file that cannot show it is refused and nothing is written",
          "[image_io]") {
    const std::string name = GENERATE("a.png", "a.bmp", "a.hdr");
    CAPTURE(name);
    const TempDir dir;
    const std::string path = dir.path(name);
    Frame frame = make_frame({5, 4}, {Plane::radiance});
    frame.radiance(3, 2).g = std::numeric_limits<float>::quiet_NaN();
    const Error error = error_of([&] { save_frame(frame, path); });
    CHECK(error.code() == ExitCode::non_finite);
    CHECK(std::string(error.what()) ==
          path + ": found nan at pixel (3, 2), channel G, allowed: finite numbers");
    CHECK(dir.names().empty());
    frame.radiance(0, 0).b = -std::numeric_limits<float>::infinity();
    CHECK(std::string(error_of([&] { save_image(frame.radiance, path); }).what()) ==
          path + ": found -inf at pixel (0, 0), channel B, allowed: finite numbers");
}

TEST_CASE("a full disk is a file error that leaves the old file and nothing else", "[image_io]") {
    const std::string name = GENERATE(from_range(std::begin(kEveryFormat), std::end(kEveryFormat)));
    CAPTURE(name);
    const TempDir dir;
    const Image image = make_image({120, 100});
    save_image(image, dir.path("whole-" + name));
    const std::size_t size = dir.read("whole-" + name).size();
    const std::string path = dir.write(name, "old");
    for (const std::size_t room : {std::size_t{0}, size / 2, size - 1}) {
        CAPTURE(room);
        std::string message;
        {
            const DiskQuota quota(room);
            const Error error = error_of([&] { save_image(image, path); });
            CHECK(error.code() == ExitCode::file);
            message = error.what();
        }
        CHECK(message.starts_with(path + ": cannot be written: "));
        CHECK(message.find(".tmp") == std::string::npos);
        CHECK(dir.read(name) == "old");
        CHECK(dir.names() == FileNames{name, "whole-" + name});
    }
}

TEST_CASE("a place where no file can be made is named with the system's reason", "[image_io]") {
    const TempDir dir;
    const Image image = make_image({2, 2});
    const std::string below_file = dir.write("file", "") + "/a.png";
    CHECK(std::string(error_of([&] { save_image(image, below_file); }).what()) ==
          below_file + ": cannot be written: " + dir.path("file") + ": Not a directory");
    const std::string nowhere = dir.path("nowhere/a.exr");
    const Error error = error_of([&] { save_image(image, nowhere); });
    CHECK(error.code() == ExitCode::file);
    CHECK(std::string(error.what()) ==
          nowhere + ": cannot be written: " + dir.path("nowhere") + ": No such file or directory");
    CHECK(dir.names() == FileNames{"file"});
}

TEST_CASE("a directory is not replaced by an image", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.path("a.png");
    std::filesystem::create_directory(path);
    const Error error = error_of([&] { save_image(make_image({2, 2}), path); });
    CHECK(error.code() == ExitCode::file);
    CHECK(std::string(error.what()) == path + ": cannot be written: it is a directory");
    CHECK(dir.names() == FileNames{"a.png"});
}

TEST_CASE("an extension that cannot be written is refused before any work", "[image_io]") {
    const Error usage = error_of([] { require_writable_extension("out.jpg"); });
    CHECK(usage.code() == ExitCode::usage);
    CHECK(std::string(usage.what()) ==
          "out.jpg: found extension .jpg, allowed: " + writable_extensions());
    CHECK(std::string(error_of([] { require_writable_extension("dir.png/out"); }).what()) ==
          "dir.png/out: found no extension, allowed: " + writable_extensions());
    const TempDir dir;
    const auto save = [&] { save_frame(make_frame({2, 2}, Planes::all()), dir.path("out.jpg")); };
    CHECK(error_of(save).code() == ExitCode::file);
    CHECK(dir.names().empty());
}

TEST_CASE("8-bit pictures go into 8-bit files only", "[image_io]") {
    const TempDir dir;
    const Grid<glm::u8vec3> raster({2, 2});
    CHECK(error_of([&] { save_raster(raster, dir.path("a.exr")); }).code() == ExitCode::file);
    CHECK(dir.names().empty());
}

TEST_CASE("an image without pixels and planes of unlike sizes are mismatches", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.path("a.exr");
    const Error empty = error_of([&] { save_frame({}, path); });
    CHECK(empty.code() == ExitCode::mismatch);
    CHECK(std::string(empty.what()) ==
          path + ": found an image of 0x0, allowed: 1 to 2147483647 pixels");
    Frame frame = make_frame({4, 3}, {Plane::radiance});
    frame.normal_world = Grid<glm::vec3>({3, 4});
    const Error unlike = error_of([&] { save_frame(frame, path); });
    CHECK(unlike.code() == ExitCode::mismatch);
    CHECK(std::string(unlike.what()) == path + ": found plane normal of 3x4, allowed: 4x3");
    CHECK(dir.names().empty());
}

TEST_CASE("a temporary file that is not wanted leaves nothing", "[files]") {
    const TempDir dir;
    {
        const TemporaryFile file(dir.path("a.txt"));
        CHECK(std::fputs("half", file.stream()) >= 0);
        CHECK(dir.names().size() == 1);
    }
    CHECK(dir.names().empty());
}

TEST_CASE("a temporary file takes its target's place with what was written", "[files]") {
    const TempDir dir;
    const std::string path = dir.write("a.txt", "old");
    TemporaryFile file(path);
    CHECK(std::fputs("new", file.stream()) >= 0);
    file.replace_target();
    CHECK(dir.names() == FileNames{"a.txt"});
    CHECK(read_file(path) == "new");
}

TEST_CASE("an EXR file with channels of a type that there is not cannot be read", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.path("a.exr");
    save_image(make_image({2, 2}), path);
    std::string bytes = dir.read("a.exr");
    const std::size_t type = bytes.find(std::string("chlist\0", 7)) + 7 + 4 + 2;  // after "B"
    REQUIRE(bytes[type] == 2);
    bytes[type] = 3;
    dir.write("a.exr", bytes);
    const Error error = error_of([&] { (void)load_frame(path); });
    CHECK(error.code() == ExitCode::file);
    CHECK(std::string(error.what()) ==
          path + ": cannot be read: channel B is of the unknown type 3");
}
