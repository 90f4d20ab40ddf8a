// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/beams.hpp"
#include "laser/cut.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/splitting/run_fit.hpp"

namespace orchard::laser {

/// Joins runs again that something thin in front (grass, a twig: at most merge_occluded_beams
/// beams, all of them nearer) has parted, when one circle fits both. The thin thing stays an object
/// of its own.
void rejoin(const Beams& beams, const SegmentationConfig& config, RunFitter& fit,
            std::vector<Run>& runs);

}  // namespace orchard::laser
