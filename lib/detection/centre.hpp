// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/detection.hpp"
#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "laser/segment.hpp"

namespace orchard::detection {

/// Fills a detection's surface and centre in the base frame, and the centre's covariance. The
/// centre is that of the segment's circle, or without a circle range + radius along the bearing.
/// `is_trunk`: the width model applies, and the radius is the variance-weighted mean of the
/// measured radius and the model's. Source: generalises Shalal et al. 2013, eqs. 11, 12 (which stop
/// at the bark).
void place_in_base(Detection& detection, const laser::Segment& segment, const laser::Scan& scan,
                   bool is_trunk, const Rig& rig);

}  // namespace orchard::detection
