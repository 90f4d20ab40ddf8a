// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/beams.hpp"
#include "laser/circle_fit.hpp"
#include "laser/cut.hpp"
#include "laser/laser_config.hpp"

namespace orchard::laser {

/// Where an object ends beyond its last beam.
struct Side {
  double beyond_beams = 0.5;              ///< from the last beam on it to its edge, may be < 0
  double sd_beams = 0.28867513459481287;  ///< 1-sigma of that: it lies anywhere within a step
  bool hidden = false;                    ///< not seen: nobody knows how far it goes on
};

struct Sides {
  Side before, after;
};

/// The sides of a candidate. A side is hidden beside the scan's end, a blind sector or something
/// nearer; where that is thin (at most merge_occluded_beams beams, and what shows beyond lies
/// farther) the edge is somewhere behind it. Beside a free side the beam's spot meets the object
/// before its axis does: the edge lies half a spot nearer to the last beam.
Sides sides_of(const Beams& beams, const Candidate& candidate, const SegmentationConfig& config,
               const LaserConfig& laser);

/// What a circle is fitted to, in a frame whose x axis is the candidate's first beam and whose
/// bearings grow with the position. Overwrites `arc`.
void arc_of(const Beams& beams, const Candidate& candidate, const Sides& sides, Arc& arc);

}  // namespace orchard::laser
