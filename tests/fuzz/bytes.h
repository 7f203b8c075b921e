// SPDX-License-Identifier: Apache-2.0
//
// Values out of the bytes that a fuzzer makes up. Where the bytes end, everything is 0.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace vecino::fuzz {

class Bytes {
  public:
    explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    [[nodiscard]] bool empty() const { return bytes_.empty(); }

    std::uint8_t byte() {
        if (bytes_.empty()) return 0;
        const std::uint8_t value = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return value;
    }
    std::uint32_t word() {
        std::uint32_t value = 0;
        for (int i = 0; i < 4; ++i) value = value << 8 | byte();
        return value;
    }
    bool chance_in(int n) { return byte() % n == n - 1; }

    /// From least to most; spans of up to 256 values take one byte, others four.
    int integer(int least, int most) {
        const auto span = static_cast<std::int64_t>(most) - least + 1;
        const std::uint32_t value = span <= 256 ? byte() : word();
        return static_cast<int>(least + static_cast<std::int64_t>(value) % span);
    }

    /// One of the places where arithmetic breaks, a plain number, or any bits at all.
    float real() {
        using Limits = std::numeric_limits<float>;
        constexpr float kSpecial[] = {0.0f,
                                      -0.0f,
                                      1.0f,
                                      -1.0f,
                                      0.5f,
                                      Limits::quiet_NaN(),
                                      Limits::infinity(),
                                      -Limits::infinity(),
                                      Limits::max(),
                                      Limits::lowest(),
                                      Limits::min(),
                                      Limits::denorm_min(),
                                      -Limits::denorm_min(),
                                      1.0e-20f,
                                      1.0e20f,
                                      0x1p31f};
        constexpr std::uint8_t kSpecials = std::size(kSpecial);
        const std::uint8_t kind = byte();
        if (kind < kSpecials) return kSpecial[kind];
        if (kind == 255) return std::bit_cast<float>(word());
        return static_cast<float>(kind - kSpecials) / 128.0f;
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

}  // namespace vecino::fuzz
