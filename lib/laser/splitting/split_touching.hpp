// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/beams.hpp"
#include "laser/candidate.hpp"
#include "laser/laser_config.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/splitting/candidate_fit.hpp"
#include "laser/width_config.hpp"

namespace orchard::laser {

/// Splits candidates that two circles explain clearly better than one: trunks that touch, side by
/// side or one behind the other, and trunks widened by a few beams of grass or a stake. `width`
/// says how wide trunks are.
void split_touching(const Beams& beams, const SegmentationConfig& config, const WidthConfig& width,
                    const LaserConfig& laser, CandidateFitter& fit,
                    std::vector<Candidate>& candidates);

}  // namespace orchard::laser
