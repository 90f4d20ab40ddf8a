// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "detection/detect.hpp"
#include "detection/trunk_view.hpp"
#include "vision/edges.hpp"

namespace orchard::detection {

/// A pair of image edges that may be an object's two sides.
struct EdgeOffset {
  double left_px = 0.0;   ///< left edge: found column minus column expected by the laser
  double right_px = 0.0;  ///< right edge: likewise
  double roc = 0.0;       ///< roc of the weaker edge

  double middle_px() const { return 0.5 * (left_px + right_px); }
};

/// The area of the image that edge_offsets() reads.
vision::PixelRect edge_offset_area(const TrunkView& view, double reach_px, const Rig& rig);

/// Finds all pairs of edges whose distance matches the laser's width and whose middle is within
/// `reach_px` of the expected column; the strongest first. The search is wider than the detector's
/// windows, so that a camera's rotation or delay can be measured.
std::vector<EdgeOffset> edge_offsets(const vision::EdgeMap& map, const TrunkView& view,
                                     double reach_px, const Rig& rig);

/// The edge pairs found for one candidate.
struct CandidateEdges {
  std::size_t candidate = 0;  ///< into LaserFindings::candidates
  TrunkView view;
  std::vector<EdgeOffset> offsets;  ///< at least one
};

/// Runs edge_offsets() for every candidate in the camera's view. Empty if the image does not decode
/// or has another size than the camera. Also announces the regions that judge_by_camera() will
/// read, so that the image is decoded only once.
std::vector<CandidateEdges> find_candidate_edges(const LaserFindings& findings,
                                                 vision::PictureReader& picture, const Rig& rig,
                                                 const std::optional<Motion>& motion,
                                                 double reach_px);

}  // namespace orchard::detection
