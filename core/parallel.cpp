// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.h"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <algorithm>
#include <atomic>
#include <exception>

namespace vecino {

int default_thread_count() {
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;  // as fuzz targets are built: where blocks run one after the other
#endif
}

void for_each_block(std::size_t count, std::size_t block_size, int threads,
                    const std::function<void(BlockRange)>& body) {
    const auto blocks = static_cast<long long>((count + block_size - 1) / block_size);
    [[maybe_unused]] const int team = threads > 0 ? threads : default_thread_count();
    std::exception_ptr failure;
    std::atomic<bool> failed = false;
#pragma omp parallel for schedule(dynamic, 1) num_threads(team)
    for (long long block = 0; block < blocks; ++block) {
        if (failed.load(std::memory_order_relaxed)) continue;
        try {
            const auto begin = static_cast<std::size_t>(block) * block_size;
            body({begin, std::min(begin + block_size, count)});
        } catch (...) {
#pragma omp critical
            if (!failed.exchange(true)) failure = std::current_exception();
        }
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace vecino
