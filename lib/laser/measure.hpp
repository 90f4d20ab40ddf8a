// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/beams.hpp"
#include "laser/cut.hpp"
#include "laser/laser_config.hpp"
#include "laser/segment.hpp"
#include "laser/splitting/run_fit.hpp"

namespace orchard::laser {

/// What a run of beams tells of its object. `arc` is a buffer.
Segment measure(const Scan& scan, const Beams& beams, const Run& run,
                const SegmentationConfig& config, const WidthConfig& width,
                const LaserConfig& laser, RunFitter& fit);

}  // namespace orchard::laser
