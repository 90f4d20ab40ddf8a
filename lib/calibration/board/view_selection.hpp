// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/board/camera_calibration.hpp"

namespace orchard::calibration {

/// Selects at most `count` views that differ most in position, size and tilt, because a recording
/// contains hundreds of similar ones. Returns indices in ascending order.
std::vector<std::size_t> select_spread(const std::vector<NamedView>& views, int width_px,
                                       int height_px, std::size_t count);

}  // namespace orchard::calibration
