// SPDX-License-Identifier: Apache-2.0
//
// Which kernels this build holds and this machine can run.
#include "core/trace_task.h"

namespace vecino {

extern const TraceKernel kTraceKernel1;
extern const TraceKernel kTraceKernel4;
#ifdef VECINO_WIDE_KERNELS
extern const TraceKernel kTraceKernel8;
extern const TraceKernel kTraceKernel16;
#endif

const TraceKernel* find_trace_kernel(int width) {
    if (width == 1) return &kTraceKernel1;
    if (width == 4) return &kTraceKernel4;
#ifdef VECINO_WIDE_KERNELS
    __builtin_cpu_init();
    if (width == 8 && __builtin_cpu_supports("avx2")) return &kTraceKernel8;
    if (width == 16 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")) {
        return &kTraceKernel16;
    }
#endif
    return nullptr;
}

}  // namespace vecino
