// SPDX-License-Identifier: Apache-2.0
//
// For functions whose loops gain from wide vectors outside the tracing kernels: VECINO_CLONES
// compiles one for several instruction sets, of which the loader picks one. Only what is inlined
// into it gains, and not through lambdas.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define VECINO_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VECINO_CLONES
#endif

#define VECINO_INLINE [[gnu::always_inline]] inline
