// SPDX-License-Identifier: Apache-2.0
#include "core/sample_sums.h"

#include <array>
#include <utility>

#include "core/memory.h"

namespace vecino {

SampleSums::SampleSums(Extent size, std::size_t sums_per_pixel)
    : size_(size),
      sums_per_pixel_(sums_per_pixel),
      planes_(std::make_unique<Plane[]>(sums_per_pixel * ExactSum::kDigits)) {}

std::vector<float>& SampleSums::make_plane(std::size_t sum, std::size_t digit) {
    Plane& plane = planes_[index(sum, digit)];
    std::call_once(plane.made, [&] {
        require_memory(size_.area() * sizeof(float), "sums of " + size_text(size_));
        plane.values.resize(size_.area());
        plane.is_made.store(true, std::memory_order_release);
    });
    return plane.values;
}

const std::vector<float>& SampleSums::plane(std::size_t sum, std::size_t digit) const {
    return planes_[index(sum, digit)].values;
}

void SampleSums::set_plane(std::size_t sum, std::size_t digit, std::vector<float> values) {
    Plane& plane = planes_[index(sum, digit)];
    std::call_once(plane.made, [&] {
        plane.values = std::move(values);
        plane.is_made.store(true, std::memory_order_release);
    });
}

void SampleSums::store(std::size_t pixel, std::span<const ExactSum::Digits> sums) {
    for (std::size_t sum = 0; sum < sums_per_pixel_; ++sum) {
        for (std::size_t digit = 0; digit < ExactSum::kDigits; ++digit) {
            const float value = sums[sum][digit];
            // What another thread is just making holds a 0 for this pixel already.
            if (value != 0.0f || is_made(sum, digit)) make_plane(sum, digit)[pixel] = value;
        }
    }
}

void SampleSums::load(std::size_t pixel, std::span<ExactSum::Digits> out) const {
    for (std::size_t sum = 0; sum < sums_per_pixel_; ++sum) {
        for (std::size_t digit = 0; digit < ExactSum::kDigits; ++digit)
            out[sum][digit] = is_made(sum, digit) ? plane(sum, digit)[pixel] : 0.0f;
    }
}

void SampleSums::add(std::size_t pixel, std::span<const ExactSum::Digits> sums) {
    std::vector<ExactSum::Digits> totals(sums_per_pixel_);
    load(pixel, totals);
    for (std::size_t sum = 0; sum < sums_per_pixel_; ++sum) {
        ExactSum total;
        total.add(totals[sum]);
        total.add(sums[sum]);
        totals[sum] = total.digits();
    }
    store(pixel, totals);
}

void SampleSums::add(const SampleSums& other) {
    for (std::size_t sum = 0; sum < sums_per_pixel_; ++sum) add_plane(other, sum);
}

void SampleSums::add_plane(const SampleSums& other, std::size_t sum) {
    std::array<float*, ExactSum::kDigits> to{};
    std::array<const float*, ExactSum::kDigits> from{};
    for (std::size_t digit = 0; digit < ExactSum::kDigits; ++digit) {
        const std::vector<float>& theirs = other.plane(sum, digit);
        from[digit] = theirs.empty() ? nullptr : theirs.data();
        to[digit] = plane(sum, digit).empty() ? nullptr : make_plane(sum, digit).data();
    }
    for (std::size_t pixel = 0; pixel < size_.area(); ++pixel) {
        ExactSum::Digits ours{}, theirs{};
        for (std::size_t digit = 0; digit < ExactSum::kDigits; ++digit) {
            if (to[digit] != nullptr) ours[digit] = to[digit][pixel];
            if (from[digit] != nullptr) theirs[digit] = from[digit][pixel];
        }
        ExactSum total;
        total.add(ours);
        total.add(theirs);
        const ExactSum::Digits digits = total.digits();
        for (std::size_t digit = 0; digit < ExactSum::kDigits; ++digit) {
            if (to[digit] == nullptr) {
                if (digits[digit] == 0.0f) continue;
                to[digit] = make_plane(sum, digit).data();
            }
            to[digit][pixel] = digits[digit];
        }
    }
}

}  // namespace vecino
