// SPDX-License-Identifier: Apache-2.0
//
// Render methods that the thesis planned or left to future work.
#pragma once

#include "filters/methods.h"

namespace vecino {

/// Task 11, in both of its meanings.
MethodRender render_interleaved(const MethodRequest& request, const Progress& progress);

/// Task 12: traces a coarse lattice, interpolates between traced pixels of one surface where they
/// agree, traces where they do not, from coarse to fine.
MethodRender render_adaptive(const MethodRequest& request, const Progress& progress);

/// Future work: a pixel takes the colour of a traced one whose hit is near to its own in space.
MethodRender render_reuse(const MethodRequest& request, const Progress& progress);

/// Future work: a pixel is sampled until its samples vary little.
MethodRender render_variation(const MethodRequest& request, const Progress& progress);

}  // namespace vecino
