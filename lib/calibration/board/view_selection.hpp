// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/board/camera_calibration.hpp"

namespace orchard::calibration {

/// At most `count` views that differ as much as possible in place, size and tilt, in rising order:
/// a recording holds hundreds that are nearly the same. All of them when there are no more.
std::vector<std::size_t> select_spread(const std::vector<NamedView>& views, int width_px,
                                       int height_px, std::size_t count);

}  // namespace orchard::calibration
