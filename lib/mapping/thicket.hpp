// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// How far the parts of one bush or heap stand from each other at most [m].
inline constexpr double kThicket_m = 0.8;

/// Which landmarks stand so close together that they are parts of one thing, or might be taken for
/// each other: two others within half a metre, stakes and stalks not counted. Each look at a
/// bush shows other parts of it, so what such a landmark is, and where, says little.
std::vector<char> in_thickets(const std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
