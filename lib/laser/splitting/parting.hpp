// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/beams.hpp"
#include "laser/cut.hpp"
#include "laser/laser_config.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/splitting/run_fit.hpp"

namespace orchard::laser {

/// Parts runs that one circle does not explain where two explain them clearly better: trunks that
/// touch, one beside or behind the other, and what few beams of grass or a stake widen a trunk.
void split_touching(const Beams& beams, const SegmentationConfig& config, const LaserConfig& laser,
                    RunFitter& fit, std::vector<Run>& runs);

}  // namespace orchard::laser
