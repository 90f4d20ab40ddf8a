// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/beams.hpp"
#include "laser/cut.hpp"
#include "laser/laser_config.hpp"
#include "laser/segment.hpp"
#include "laser/splitting/candidate_fit.hpp"

namespace orchard::laser {

/// Measures the object of a segment candidate: bearings, width, circle and shape. `fit` caches the
/// circles of this scan.
Segment measure(const Scan& scan, const Beams& beams, const Candidate& candidate,
                const SegmentationConfig& config, const WidthConfig& width,
                const LaserConfig& laser, CandidateFitter& fit);

}  // namespace orchard::laser
