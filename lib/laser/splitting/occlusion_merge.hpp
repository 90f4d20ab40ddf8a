// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/beams.hpp"
#include "laser/candidate.hpp"
#include "laser/segmentation_config.hpp"
#include "laser/splitting/candidate_fit.hpp"

namespace orchard::laser {

/// Merges candidates divided by thin foreground clutter (grass, a twig: at most
/// merge_occluded_beams beams, all of them nearer), if one circle fits both. The clutter stays a
/// separate object.
void merge_occluded(const Beams& beams, const SegmentationConfig& config, CandidateFitter& fit,
                    std::vector<Candidate>& candidates);

}  // namespace orchard::laser
