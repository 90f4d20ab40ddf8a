// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/beams.hpp"
#include "laser/candidate.hpp"
#include "laser/circle_fit.hpp"
#include "laser/laser_config.hpp"

namespace orchard::laser {

/// Position of an object's edge relative to its outermost beam.
struct Side {
  double beyond_beams = 0.5;              ///< distance from that beam to the edge; may be < 0
  double sd_beams = 0.28867513459481287;  ///< 1-sigma: uniform within a beam step
  bool hidden = false;                    ///< the edge is not visible; its position is unknown
};

struct Sides {
  Side before, after;
};

/// Determines both sides of a candidate. A side is hidden beside the end of the scan, a blind
/// sector or a nearer object. At a free side the spot meets the object before the beam's axis does,
/// so the edge is half a spot nearer to the beam.
Sides sides_of(const Beams& beams, const Candidate& candidate, const LaserConfig& laser);

/// Fills `arc` with the measurements for a circle fit, in a frame whose x axis is the candidate's
/// first beam and whose bearings increase with the position.
void arc_of(const Beams& beams, const Candidate& candidate, const Sides& sides, Arc& arc);

}  // namespace orchard::laser
