// SPDX-License-Identifier: Apache-2.0
//
// Runs a fuzz target over the files of a folder and over changed ones, without a fuzzer: any
// compiler builds it, and it does the same every time. Usage: replay FOLDER CHANGES
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/files.h"
#include "tests/fuzz/json_mutator.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using vecino::fuzz::RandomEngine;

constexpr std::size_t kMostBytes = 1 << 16;

std::vector<std::string> files_in(const std::string& folder) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        files.push_back(entry.path().string());
    std::ranges::sort(files);
    return files;
}

/// Bytes overwritten, taken out, doubled; or the end cut off.
std::string changed_bytes(std::string bytes, RandomEngine& random) {
    for (auto count = random() % 4 + 1; count > 0 && !bytes.empty(); --count) {
        const std::size_t at = random() % bytes.size();
        const std::size_t length = std::min<std::size_t>(random() % 8 + 1, bytes.size() - at);
        switch (random() % 5) {
            case 0:
                bytes.erase(at, length);
                break;
            case 1:
                bytes.insert(at, bytes.substr(at, length));
                break;
            case 2:
                bytes.resize(random() % 8 == 0 ? at : bytes.size());
                break;
            case 3:
                bytes.replace(at, length, length, random() % 2 == 0 ? '\xFF' : '\0');
                break;
            default:
                bytes[at] = static_cast<char>(random());
        }
    }
    return bytes;
}

std::string changed(const std::string& bytes, RandomEngine& random) {
    if (random() % 4 == 0) return changed_bytes(bytes, random);
    const std::string json = vecino::fuzz::mutated_json(bytes, kMostBytes, random);
    return json.empty() ? changed_bytes(bytes, random) : json;
}

void run(const std::string& bytes) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

/// Each change starts from what the one before left, and now and then from the file again.
void run_changed(const std::string& bytes, int changes, RandomEngine& random) {
    std::string current = bytes;
    for (int i = 0; i < changes; ++i) {
        if (i % 8 == 0 || current.empty()) current = bytes;
        current = changed(current, random);
        run(current);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: replay FOLDER CHANGES\n"), 64;
    RandomEngine random(1);
    int inputs = 0;
    const int changes = std::atoi(argv[2]);
    for (const std::string& file : files_in(argv[1])) {
        std::fprintf(stderr, "%s\n", file.c_str());  // the last one named is the one that broke
        const std::string bytes = vecino::read_file(file);
        run(bytes);
        run_changed(bytes, changes, random);
        inputs += 1 + changes;
    }
    std::printf("%d inputs keep the contract\n", inputs);
    return inputs > 0 ? 0 : 1;
}
