// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/detection.hpp"
#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "laser/segment.hpp"

namespace orchard::detection {

/// Fills a detection's surface and centre in base, and the centre's covariance: base <- laser <-
/// the centre of the segment's circle, or where it has none polar(range + radius). `is_trunk` says
/// that the width model holds, so that the radius is the mean of what was measured and what trunks
/// have, weighted by their variances. Source: generalises Shalal et al. 2013, eqs. 11, 12 (which
/// stop at the bark).
void place_in_base(Detection& detection, const laser::Segment& segment, const laser::Scan& scan,
                   bool is_trunk, const Rig& rig);

}  // namespace orchard::detection
