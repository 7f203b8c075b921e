// SPDX-License-Identifier: Apache-2.0
#include "eval/image_series.h"

#include <filesystem>
#include <limits>

#include "core/error.h"
#include "core/image_io.h"
#include "eval/error_map.h"
#include "eval/gate_report.h"
#include "eval/metrics.h"

namespace vecino {
namespace {

namespace fs = std::filesystem;

std::string numbered(const fs::path& path, int number) {
    const std::string name =
        path.stem().string() + "_" + std::to_string(number) + path.extension().string();
    return (path.parent_path() / name).string();
}

/// How close two images are in dB; below all numbers where they cannot be compared.
double closeness_db(const Image& test, const Image& valid) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (test.size() != valid.size()) return -infinite;
    const Comparison comparison = compare(test, valid);
    if (!comparison.metrics) return -infinite;
    return comparison.metrics->psnr_float_db.value_or(infinite);
}

}  // namespace

std::vector<std::string> valid_images(const std::string& path) {
    std::vector<std::string> found;
    if (fs::exists(path)) found.push_back(path);
    for (int number = 1; fs::exists(numbered(path, number)); ++number)
        found.push_back(numbered(path, number));
    return found;
}

std::string best_valid_image(const std::string& test, const std::string& path) {
    const std::vector<std::string> candidates = valid_images(path);
    if (candidates.empty())
        throw Error(ExitCode::quality, path + ": there is no such baseline: if " + test +
                                           " is as it should be, copy it there");
    const Image image = load_image(test);
    std::string best = candidates.front();
    double best_db = -std::numeric_limits<double>::infinity();
    for (const std::string& candidate : candidates) {
        const double db = closeness_db(image, load_image(candidate));
        if (db <= best_db) continue;
        best_db = db;
        best = candidate;
    }
    return best;
}

std::string write_comparison(const Image& test, const Image& valid, const std::string& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw Error(ExitCode::file, folder + ": cannot make the directory: " + error.message());
    const auto file = [&](const char* name) {
        return fs::absolute(fs::path(folder) / name).lexically_normal().string();
    };
    save_image(test, file("test.png"));
    save_image(valid, file("valid.png"));
    const Grid<float> values = error_values(test, valid, ErrorKind::magnitude);
    save_raster(
        error_picture(values, {ErrorKind::magnitude, suggested_range(values), "test - valid"}),
        file("difference.png"));
    return ctest_image("TestImage", file("test.png")) +
           ctest_image("ValidImage", file("valid.png")) +
           ctest_image("DifferenceImage2", file("difference.png"));
}

}  // namespace vecino
