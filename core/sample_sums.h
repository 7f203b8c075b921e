// SPDX-License-Identifier: Apache-2.0
//
// Exact sums for each pixel of a frame, kept as one plane per sum and digit. A plane is made when
// the first digit other than 0 comes: light spans few of the digits that a sum could have.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/exact_sum.h"
#include "core/grid.h"

namespace vecino {

/// Memory: 4 bytes per pixel and plane made; in a usual scene 3 or 4 planes per sum, at most 16.
class SampleSums {
  public:
    SampleSums() = default;
    /// All sums are 0.
    SampleSums(Extent size, std::size_t sums_per_pixel);

    [[nodiscard]] Extent size() const { return size_; }
    [[nodiscard]] std::size_t sums_per_pixel() const { return sums_per_pixel_; }

    /// Gives a pixel its sums, in place of those that it had. Several threads may, for different
    /// pixels.
    void store(std::size_t pixel, std::span<const ExactSum::Digits> sums);

    /// The sums of a pixel. Precondition: out has sums_per_pixel() entries.
    void load(std::size_t pixel, std::span<ExactSum::Digits> out) const;

    /// Adds all sums of another frame. Precondition: size and sums_per_pixel are equal.
    void add(const SampleSums& other);

    /// Values of a digit of a sum, one per pixel; empty where all are 0.
    [[nodiscard]] const std::vector<float>& plane(std::size_t sum, std::size_t digit) const;
    /// Gives a digit its values, once.
    void set_plane(std::size_t sum, std::size_t digit, std::vector<float> values);

    /// Adds to the sums of a pixel. Several threads may, for different pixels.
    void add(std::size_t pixel, std::span<const ExactSum::Digits> sums);

  private:
    struct Plane {
        std::once_flag made;
        std::atomic<bool> is_made = false;
        std::vector<float> values;
    };
    [[nodiscard]] bool is_made(std::size_t sum, std::size_t digit) const {
        return planes_[index(sum, digit)].is_made.load(std::memory_order_acquire);
    }
    [[nodiscard]] std::size_t index(std::size_t sum, std::size_t digit) const {
        return sum * ExactSum::kDigits + digit;
    }
    std::vector<float>& make_plane(std::size_t sum, std::size_t digit);
    void add_plane(const SampleSums& other, std::size_t sum);

    Extent size_;
    std::size_t sums_per_pixel_ = 0;
    std::unique_ptr<Plane[]> planes_;
};

}  // namespace vecino
