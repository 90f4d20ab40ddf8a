// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/figure/canvas.hpp"

namespace orchard::io {

// The colours of the page that shows a map (its light theme in lib/view/web/style.css), and a
// darker shade of each for borders and numbers.
inline constexpr Colour kTreeColour{47, 125, 79}, kTreeInk{27, 84, 51};
inline constexpr Colour kTrunkColour{159, 194, 164}, kTrunkInk{95, 130, 101};
inline constexpr Colour kObjectColour{180, 83, 47}, kObjectInk{140, 62, 33};
inline constexpr Colour kUnseenColour{135, 141, 147}, kUnseenInk{102, 112, 106};
inline constexpr Colour kPathColour{59, 110, 168}, kRowColour{169, 191, 174},
    kGapColour{185, 130, 9};
inline constexpr Colour kRowInk{70, 110, 82}, kAisleColour{205, 192, 150};

}  // namespace orchard::io
