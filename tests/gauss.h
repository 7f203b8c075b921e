// SPDX-License-Identifier: Apache-2.0
//
// Noise for tests.
#pragma once

#include <cmath>
#include <random>

namespace vecino {

/// Whole numbers of the generator alone, so that every library draws the same.
class Gauss {
  public:
    explicit Gauss(unsigned seed) : engine_(seed) {}
    double operator()() {
        const double radius = std::sqrt(-2 * std::log(unit()));
        return radius * std::cos(2 * std::acos(-1.0) * unit());
    }

  private:
    double unit() { return (static_cast<double>(engine_()) + 0.5) * 0x1p-32; }
    std::mt19937 engine_;
};

}  // namespace vecino
