// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "detection/detect.hpp"
#include "detection/rig.hpp"
#include "detection/trunk_view.hpp"
#include "detection/tuning.hpp"
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

/// Extrinsics monitor: compares the edges found in images with the columns expected by the laser,
/// and warns when the running median of the offsets is certain to be large. Time is message time.
///
/// The median is signed. It detects a camera rotated about its vertical axis, and a delay while the
/// robot turns one way. A delay cancels over curves to both sides; `orchard calibrate delay`
/// measures it. Disagreements beyond tuning::kSearchWindow_deg are not detected.
class ConsistencyMonitor {
 public:
  /// `focal_px`: the camera's horizontal focal length, to convert pixels to degrees.
  ConsistencyMonitor(const ConsistencyConfig& config, double focal_px);

  /// Whether the next comparison is due; they are limited in rate because edges are costly.
  bool is_due(std::int64_t utime) const;

  /// Adds the offsets found at a time [us], in order of time: found minus expected column of each
  /// object's middle [px]. Empty if the image showed none.
  void add(std::int64_t utime, const std::vector<double>& offsets_px);

  /// Of the running median.
  int num_observations() const { return static_cast<int>(observations_.size()); }
  bool is_raised() const { return raised_; }

  /// The present disagreement as a message for the user; empty unless raised.
  std::string warning() const;
  /// The largest disagreement of the whole run as a message; empty if it was never raised.
  std::string run_summary() const;

 private:
  struct Observation {
    std::int64_t utime;
    double offset_px;
  };
  double degrees(double offset_px) const;
  std::string disagreement(const char* verb, double offset_px, double duration_s) const;

  ConsistencyConfig config_;
  double focal_px_;
  std::deque<Observation> observations_;
  std::int64_t first_utime_ = INT64_MIN;
  std::int64_t last_utime_ = INT64_MIN;
  double median_px_ = 0.0;
  bool raised_ = false;
  std::int64_t raised_us_ = 0;  ///< total time raised in the whole run
  double worst_px_ = 0.0;       ///< largest median while raised
};

}  // namespace orchard::detection
