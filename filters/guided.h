// SPDX-License-Identifier: Apache-2.0
//
// The schemes that take a guide.
#pragma once

#include "filters/schemes.h"

namespace vecino {

/// Kopf, Cohen, Lischinski and Uyttendaele, "Joint Bilateral Upsampling", 2007, with geometry as
/// the range.
Reconstruction joint_bilateral(const GuidedTask& task);

/// Weighted least squares of order 0 to 2 over the irradiance of a surface.
Reconstruction guided_fit(const GuidedTask& task);

}  // namespace vecino
