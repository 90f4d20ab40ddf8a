// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/scan.hpp"

namespace orchard::calibration {

/// Averages scans of a static scene beam by beam. Only ranges close to the median are averaged, so
/// that a beam on an edge does not end up between two surfaces. A beam without return in more than
/// half of the scans has no return. utime and seq are those of the middle scan. Throws
/// std::invalid_argument for no scan or scans of different shapes.
laser::Scan mean_scan(const std::vector<laser::Scan>& scans);

}  // namespace orchard::calibration
