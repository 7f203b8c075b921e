// SPDX-License-Identifier: Apache-2.0
//
// The one place with OpenMP. Work is handed out in blocks; which thread runs a block, and when,
// must not change what it computes.
#pragma once

#include <cstddef>
#include <functional>

namespace vecino {

/// Hardware threads that a parallel loop uses when none are asked for.
int default_thread_count();

struct BlockRange {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// Runs body over [0, count) in blocks of block_size on the given number of threads (0:
/// default_thread_count()). Exceptions leave the loop: the first one is thrown again here, after
/// the other blocks were skipped.
void for_each_block(std::size_t count, std::size_t block_size, int threads,
                    const std::function<void(BlockRange)>& body);

}  // namespace vecino
