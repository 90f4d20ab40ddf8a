// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// Width limits of a leg [m]: at the height of knees and calves legs are 0.10 to 0.14 m thick
/// (girth 0.33 to 0.43 m); trousers and measurement errors widen them, occlusion narrows them.
inline constexpr double kLegMin_m = 0.08, kLegMax_m = 0.22;

/// Distance between the centres of the legs of a standing person [m].
inline constexpr double kStanceMin_m = 0.10, kStanceMax_m = 0.45;

}  // namespace orchard::mapping
