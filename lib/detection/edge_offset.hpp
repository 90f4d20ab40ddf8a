// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "detection/detect.hpp"
#include "detection/trunk_view.hpp"
#include "vision/edges.hpp"

namespace orchard::detection {

/// A pair of edges in a picture that may be an object's two sides.
struct EdgeOffset {
  double left_px = 0.0;   ///< column found minus column that the laser expects
  double right_px = 0.0;  ///< the same of the right edge
  double roc = 0.0;       ///< of the weaker of the two edges

  double middle_px() const { return 0.5 * (left_px + right_px); }
};

/// The part of the picture that edge_offsets() reads.
vision::PixelRect edge_offset_area(const TrunkView& view, double reach_px, const Rig& rig);

/// Every pair of edges that stands as far apart as the laser says and within `reach_px` of where it
/// expects them; the strongest first. Wider than the detector's own windows, so that a camera that
/// is turned, or late, is found out and measured.
std::vector<EdgeOffset> edge_offsets(const vision::EdgeMap& map, const TrunkView& view,
                                     double reach_px, const Rig& rig);

/// What a picture shows of one candidate.
struct CandidateEdges {
  std::size_t candidate = 0;  ///< into LaserFindings::candidates
  TrunkView view;
  std::vector<EdgeOffset> offsets;  ///< at least one
};

/// edge_offsets() of every candidate that the camera sees. Empty for a picture that does not
/// decode. What judge_by_camera() will read of it is decoded along.
std::vector<CandidateEdges> look_for_edges(const LaserFindings& findings,
                                           vision::PictureReader& picture, const Rig& rig,
                                           const std::optional<Motion>& motion, double reach_px);

}  // namespace orchard::detection
