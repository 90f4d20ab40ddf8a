// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/beams.hpp"
#include "laser/cut.hpp"
#include "laser/laser_config.hpp"
#include "laser/segment.hpp"
#include "laser/splitting/run_fit.hpp"

namespace orchard::laser {

/// Measures one run of beams: range, bearing, width (Shalal et al. 2013, eq. 8), intensity and
/// shape. `fit` must be of the same scan: it remembers the circles already fitted to its runs.
Segment measure(const Scan& scan, const Beams& beams, const Run& run,
                const SegmentationConfig& config, const WidthConfig& width,
                const LaserConfig& laser, RunFitter& fit);

}  // namespace orchard::laser
