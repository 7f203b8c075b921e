// SPDX-License-Identifier: Apache-2.0
//
// Eight numbers side by side, for VECINO_CLONES: GCC 12 compares wider vectors lane by lane, and
// does not make vectors of many a loop over so few.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/clones.h"

namespace vecino {

using Floats8 = float __attribute__((vector_size(32)));
using Masks8 = std::int32_t __attribute__((vector_size(32)));  ///< of all bits or none

/// The first count of eight values, others 0. Both have values of the same size.
template <class Vector, class Value>
VECINO_INLINE void load(const Value* from, Vector& to, std::size_t count = 8) {
    static_assert(8 * sizeof(Value) == sizeof(Vector));
    // Of known size it is one instruction.
    if (count >= 8) {
        __builtin_memcpy(&to, from, sizeof to);
    } else {
        to = Vector{};
        __builtin_memcpy(&to, from, count * sizeof(Value));
    }
}
template <class Vector, class Value>
VECINO_INLINE void store(const Vector& from, Value* to, std::size_t count = 8) {
    static_assert(8 * sizeof(Value) == sizeof(Vector));
    if (count >= 8) {
        __builtin_memcpy(to, &from, sizeof from);
    } else {
        __builtin_memcpy(to, &from, count * sizeof(Value));
    }
}

/// Adds the values where the mask says yes.
VECINO_INLINE void add_masked(const Floats8& value, const Masks8& mask, Floats8& sum) {
    sum += (Floats8)((Masks8)value & mask);
}

}  // namespace vecino
