// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer's hooks for targets that read JSON. Half of all changes are left to its own mutator, so
// that what is no JSON is tried too.
#include <cstring>

#include "tests/fuzz/json_mutator.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

std::string text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    vecino::fuzz::RandomEngine random(seed);
    if (random() % 2 == 0) return LLVMFuzzerMutate(data, size, most);
    const std::string text = vecino::fuzz::mutated_json(text_of(data, size), most, random);
    if (text.empty()) return LLVMFuzzerMutate(data, size, most);
    std::memcpy(data, text.data(), text.size());
    return text.size();
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* data, std::size_t size,
                                                 const std::uint8_t* other, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t most,
                                                 unsigned seed) {
    vecino::fuzz::RandomEngine random(seed);
    const std::string text =
        vecino::fuzz::crossed_json(text_of(data, size), text_of(other, other_size), random);
    if (text.empty() || text.size() > most) return 0;
    std::memcpy(out, text.data(), text.size());
    return text.size();
}
