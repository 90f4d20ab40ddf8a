// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/beams.hpp"
#include "laser/candidate.hpp"
#include "laser/laser_config.hpp"
#include "laser/segment.hpp"
#include "laser/splitting/candidate_fit.hpp"

namespace orchard::laser {

/// Measures one segment candidate: range, bearing, width (Shalal et al. 2013, eq. 8), intensity and
/// shape. `fit` must belong to the same scan; it caches the circles fitted to its candidates.
Segment measure(const Scan& scan, const Beams& beams, const Candidate& candidate,
                const SegmentationConfig& config, const WidthConfig& width,
                const LaserConfig& laser, CandidateFitter& fit);

}  // namespace orchard::laser
