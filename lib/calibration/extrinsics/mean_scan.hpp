// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/scan.hpp"

namespace orchard::calibration {

/// The mean of scans of a scene that stood still, beam by beam: of the ranges near the middle one,
/// so that a beam on an edge does not land between two surfaces. A beam that more than half of the
/// scans missed has no return; time and number are the middle scan's. Throws std::invalid_argument
/// for no scan or scans of different shapes.
laser::Scan mean_scan(const std::vector<laser::Scan>& scans);

}  // namespace orchard::calibration
