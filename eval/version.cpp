// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <glm/detail/setup.hpp>
#include <opencv2/core/version.hpp>
#include <sstream>

#include "core/embree_scene.h"
#include "core/image_io.h"
#include "core/parallel.h"
#include "core/render.h"
#include "eval/commands.h"

namespace vecino {
namespace {

std::string cpu_model() {
    std::ifstream info("/proc/cpuinfo");
    std::string line;
    while (std::getline(info, line)) {
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    }
    return "unknown";
}

/// FNV-1a of the running program: tells results of different builds apart.
std::string program_hash() {
    std::ifstream program("/proc/self/exe", std::ios::binary);
    std::uint64_t hash = 0xcbf29ce484222325u;
    char buffer[65536];
    while (program.read(buffer, sizeof buffer) || program.gcount() > 0) {
        for (std::streamsize i = 0; i < program.gcount(); ++i) {
            hash = (hash ^ static_cast<unsigned char>(buffer[i])) * 0x100000001b3u;
        }
    }
    std::ostringstream text;
    text << std::hex << hash;
    return text.str();
}

std::string glm_version() {
    return std::to_string(GLM_VERSION_MAJOR) + "." + std::to_string(GLM_VERSION_MINOR) + "." +
           std::to_string(GLM_VERSION_PATCH);
}

std::string json_version() {
    return std::to_string(NLOHMANN_JSON_VERSION_MAJOR) + "." +
           std::to_string(NLOHMANN_JSON_VERSION_MINOR) + "." +
           std::to_string(NLOHMANN_JSON_VERSION_PATCH);
}

}  // namespace

nlohmann::json version_json() {
    return {{"vecino", VECINO_VERSION},
            {"commit", std::string(kCommit)},
            {"embree", embree_version()},
            {"openimageio", image_library_version()},
            {"opencv", CV_VERSION},
            {"glm", glm_version()},
            {"nlohmann_json", json_version()},
            {"cli11", CLI11_VERSION},
            {"compiler", std::string("GCC-compatible ") + __VERSION__},
            {"cpu", cpu_model()},
            {"simd_width", simd_widths().front()},
            {"threads", default_thread_count()},
            {"build", program_hash()}};
}

std::string version_text() {
    const nlohmann::json v = version_json();
    const auto text = [&](const char* key) {
        return v[key].is_string() ? v[key].get<std::string>() : v[key].dump();
    };
    const std::string commit = kCommit.empty() ? "" : " (commit " + text("commit") + ")";
    return "vecino " + text("vecino") + commit + "\nEmbree " + text("embree") + ", OpenImageIO " +
           text("openimageio") + ", OpenCV " + text("opencv") + ", GLM " + text("glm") +
           ", nlohmann-json " + text("nlohmann_json") + ", CLI11 " + text("cli11") +
           "\nSIMD width " + text("simd_width") + ", " + text("threads") + " threads, " +
           text("cpu");
}

std::string utc_time() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

}  // namespace vecino
