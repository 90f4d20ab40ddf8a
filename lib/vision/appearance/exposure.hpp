// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// What a camera's control leaves in the sun, in steps that double the light: windows are learnt at
/// all of these. Too little light cancels, as clipping does not.
inline constexpr std::array kLearntExposures_ev{0.0, 1.0, 2.0};

/// A channel's values as they would have been with `gain` times the light: sRGB's curve undone,
/// multiplied, clipped at white.
std::array<std::uint8_t, 256> exposure_curve(double gain);

/// The pixels as another exposure would have made them; each step of `exposure_ev` doubles the
/// light. What was white before stays white: darker than it was it cannot be had.
PixelBlock exposed(const PixelBlock& pixels, double exposure_ev);

}  // namespace orchard::vision
