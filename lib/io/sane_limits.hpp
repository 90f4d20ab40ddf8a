// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::io {

// What no number of a file may exceed: far beyond any orchard, yet so small that sums and squares
// of them stay finite.
inline constexpr double kMaxCoordinate_m = 1e8;  ///< projected coordinates of the earth are below
inline constexpr double kMaxRange_m = 1e4;
inline constexpr double kMaxWidth_m = 1e3;
inline constexpr double kMaxYaw_rad = 1e4;  ///< some 1600 turns: a yaw that was never wrapped

}  // namespace orchard::io
