// SPDX-License-Identifier: Apache-2.0
#include "core/png_check.h"

#include <array>
#include <cstdint>

namespace vecino {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";

constexpr std::array<std::uint32_t, 256> make_crc_table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        table[i] = i;
        for (int bit = 0; bit < 8; ++bit) {
            table[i] = (table[i] >> 1) ^ ((table[i] & 1u) != 0 ? 0xEDB88320u : 0u);
        }
    }
    return table;
}

/// PNG specification, annex D.
std::uint32_t crc32(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> table = make_crc_table();
    std::uint32_t crc = 0xFFFFFFFFu;
    for (const char c : bytes)
        crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xFFu] ^ (crc >> 8);
    return ~crc;
}

std::uint32_t big_endian(std::string_view bytes) {
    std::uint32_t value = 0;
    for (const char c : bytes.substr(0, 4)) value = value << 8 | static_cast<unsigned char>(c);
    return value;
}

}  // namespace

std::string png_fault(std::string_view bytes) {
    if (!bytes.starts_with(kSignature)) return "";
    std::size_t begin = kSignature.size();
    // A chunk: length of its data, four letters, the data, checksum of letters and data.
    while (bytes.size() - begin >= 12) {
        const std::size_t length = big_endian(bytes.substr(begin));
        if (length > bytes.size() - begin - 12) break;
        const std::string_view checked = bytes.substr(begin + 4, 4 + length);
        if (big_endian(bytes.substr(begin + 8 + length)) != crc32(checked)) {
            return "the chunk at byte " + std::to_string(begin) + " is damaged";
        }
        if (checked.starts_with("IEND")) return "";
        begin += 12 + length;
    }
    return "the file is cut off";
}

}  // namespace vecino
