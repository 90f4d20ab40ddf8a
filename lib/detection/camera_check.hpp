// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
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

/// The area of the picture that camera_sight() reads.
vision::PixelRect sight_area(const Rig& rig);

/// The edges and sides of a picture; none without an object in view, or if the picture does not
/// decode.
std::optional<CameraSight> camera_sight(const LaserFindings& findings,
                                        vision::PictureReader& picture, const Rig& rig,
                                        const std::optional<Motion>& motion);

/// Asks which other camera would explain the pictures of a drive much better than the rig's: one
/// that is turned, flipped, zoomed or delayed. It counts the upright edges that lie where the laser
/// saw the sides of objects, over a grid of all such cameras; edges by chance count equally for all
/// of them.
class CameraCheck {
 public:
  explicit CameraCheck(const Rig& rig) : rig_(rig) {}

  /// derived: number of pictures to look at: enough to tell a degree; more only cost.
  static constexpr int kPicturesMax = 60;

  void add(CameraSight sight);
  /// What was found in the pictures so far. They are judged when this is called: anew after a
  /// doubling of them, and at the end.
  const std::vector<Finding>& findings() const;
  /// Ends the input.
  void finish() { is_finished_ = true; }

 private:
  struct Camera;
  struct Tilt;
  struct Fit;
  double score(const Camera& camera, const Tilt& tilt) const;
  std::size_t stride() const;
  Fit best_of(double sign, int num_zooms, int num_delays, int num_shifts) const;
  void judge() const;
  void name(const Camera& best) const;
  void judge_tilt() const;

  const Rig& rig_;
  std::vector<CameraSight> sights_;
  std::size_t num_sides_ = 0;
  bool is_finished_ = false;
  mutable std::size_t num_judged_ = 0;  ///< pictures behind findings_
  mutable std::vector<Finding> findings_;
};

}  // namespace orchard::detection
