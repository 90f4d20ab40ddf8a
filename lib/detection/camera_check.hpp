// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "detection/detect.hpp"
#include "detection/rig.hpp"
#include "text/finding.hpp"
#include "vision/decode.hpp"

namespace orchard::detection {

/// Upright edges of one picture, and where the laser expects the sides of what it sees.
struct CameraSight {
  /// Share of edge pixels in each column of a band of rows, less the band's mean and over its
  /// spread; bands from top to bottom.
  std::vector<std::vector<float>> bands;
  std::vector<double> band_row_px;  ///< middle row of each band
  std::vector<float> all_bands;     ///< their sum
  struct Side {
    double column_px = 0.0;      ///< expected by the rig
    double row_px = 0.0;         ///< of the scan's plane there
    double slope = 0.0;          ///< columns per row of an upright line there, by the rig
    double rate_px_per_s = 0.0;  ///< change of the column if the exposure is later
  };
  std::vector<Side> sides;
};

/// The edges and sides of a picture; none without an object in view, or if the picture does not
/// decode. Also announces what judge_by_camera() will read, so that it is decoded only once.
std::optional<CameraSight> camera_sight(const LaserFindings& findings,
                                        vision::PictureReader& picture, const Rig& rig,
                                        const std::optional<Motion>& motion);

/// Picks the pictures to look at: one a second of message time, because edges are costly.
class LookTimes {
 public:
  /// Whether the picture of a scan at this time [us] is one of them; call once for each, in order.
  bool take(std::int64_t utime);

 private:
  std::optional<std::int64_t> last_utime_;
};

/// Asks which other camera would explain the last minute of pictures much better than the rig's:
/// one that is turned, flipped, zoomed or delayed. It counts the upright edges that lie where the
/// laser saw the sides of objects, over a grid of all such cameras; edges by chance count equally
/// for all of them.
class CameraCheck {
 public:
  explicit CameraCheck(const Rig& rig) : rig_(rig) {}

  /// Adds a picture, and judges the window after 15, 30 and 60 of them and after each 60 more.
  void add(CameraSight sight);
  /// Ends the input: from now on the findings are those of the whole run.
  void finish();
  /// What contradicts the rig's camera in the window when it was last judged.
  const std::vector<Finding>& findings() const { return findings_; }

 private:
  struct Camera;
  struct Tilt;
  struct Fit;
  std::vector<double> scores(const Camera& camera, const std::optional<Tilt>& tilt, int num_shifts,
                             int step_px) const;
  std::size_t stride() const;
  Fit best_of(double sign, int num_zooms, int num_delays, int num_shifts) const;
  void judge();
  void name(const Camera& best);
  void judge_tilt();

  const Rig& rig_;
  std::deque<CameraSight> sights_;  ///< the window
  std::size_t num_sides_ = 0;       ///< in the window
  std::size_t num_added_ = 0;
  std::size_t num_judged_ = 0;  ///< of num_added_
  std::vector<Finding> findings_;
  std::vector<Finding> of_run_;  ///< of all full windows, each kind once
};

}  // namespace orchard::detection
