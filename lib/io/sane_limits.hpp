// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::io {

// Upper limits of numbers in files: far beyond any orchard, yet small enough that sums and squares
// stay finite.
inline constexpr double kMaxCoordinate_m = 1e8;  ///< above any projected coordinate on the earth
inline constexpr double kMaxRange_m = 1e4;
inline constexpr double kMaxWidth_m = 1e3;
inline constexpr double kMaxYaw_rad = 1e4;  ///< about 1600 turns, for a yaw that was never wrapped

}  // namespace orchard::io
