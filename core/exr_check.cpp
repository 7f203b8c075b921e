// SPDX-License-Identifier: Apache-2.0
#include "core/exr_check.h"

#include <cstdint>
#include <optional>

namespace vecino {
namespace {

constexpr std::string_view kMagic = "\x76\x2F\x31\x01";
constexpr std::uint32_t kSeveralParts = 0x1000;  ///< a flag beside the version

/// Reads from the front; nothing where the bytes end too early.
class Header {
  public:
    explicit Header(std::string_view bytes) : bytes_(bytes) {}

    [[nodiscard]] bool at_zero() const { return bytes_.empty() || bytes_.front() == '\0'; }

    std::optional<std::string_view> text() {
        const std::size_t end = bytes_.find('\0');
        if (end == bytes_.npos) return std::nullopt;
        const std::string_view text = bytes_.substr(0, end);
        bytes_.remove_prefix(end + 1);
        return text;
    }

    std::optional<std::uint32_t> integer() {
        const auto bytes = take(4);
        if (!bytes) return std::nullopt;
        std::uint32_t value = 0;
        for (std::size_t i = 4; i > 0; --i)
            value = value << 8 | static_cast<unsigned char>((*bytes)[i - 1]);
        return value;
    }

    std::optional<std::string_view> take(std::size_t count) {
        if (count > bytes_.size()) return std::nullopt;
        const std::string_view taken = bytes_.substr(0, count);
        bytes_.remove_prefix(count);
        return taken;
    }

  private:
    std::string_view bytes_;
};

/// Of an attribute of type chlist: names, types, and 12 bytes of what plays no part here.
std::string channel_fault(std::string_view value) {
    constexpr std::uint32_t kLastType = 2;  // unsigned integer, half, float
    Header channels(value);
    while (!channels.at_zero()) {
        const auto name = channels.text();
        const auto type = channels.integer();
        if (!name || !type || !channels.take(12)) return "";
        if (*type > kLastType)
            return "channel " + std::string(name->substr(0, 60)) + " is of the unknown type " +
                   std::to_string(*type);
    }
    return "";
}

}  // namespace

std::string exr_fault(std::string_view bytes) {
    if (!bytes.starts_with(kMagic)) return "";
    Header header(bytes.substr(kMagic.size()));
    const auto version = header.integer();
    if (!version) return "";
    // A file of several parts has a header for each, and ends them with an empty one.
    const bool has_one = (*version & kSeveralParts) == 0;
    for (bool was_end = false;;) {
        const auto name = header.text();
        if (!name || (name->empty() && (was_end || has_one))) return "";
        was_end = name->empty();
        if (was_end) continue;
        const auto type = header.text();
        const auto size = header.integer();
        const auto value = size ? header.take(*size) : std::nullopt;
        if (!type || !value) return "";
        if (*type != "chlist") continue;
        const std::string fault = channel_fault(*value);
        if (!fault.empty()) return fault;
    }
}

}  // namespace vecino
