// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "detection/rig.hpp"
#include "detection/trunk_view.hpp"
#include "laser/segment.hpp"
#include "vision/edges.hpp"

namespace orchard::detection {

/// A diameter and its standard deviation.
struct MeasuredWidth {
  double width_m = 0.0;
  double sd_m = 0.0;
};

/// The diameter of a trunk by its range and the picture.
struct PictureWidth {
  MeasuredWidth laser;    ///< angle between the sides seen by the laser, at its range
  MeasuredWidth picture;  ///< angle between the sides in the picture, at the same range
  MeasuredWidth fused;    ///< by both angles
  double tilt_rad = 0.0;  ///< of the trunk from the picture's vertical, as of vision::EdgeLine
};

/// Measures a trunk's diameter perpendicular to its axis from the edge pixels about both sides.
///
/// Trunk and background differ in how many edge pixels they have, and the side itself is a line of
/// them. Each pair of columns for the two sides, with a common tilt, divides the edge windows into
/// outside, side and inside, each with a density of its own; the probability of what the picture
/// shows, over all densities, times that of the laser's angle gives the mean and the standard
/// deviation of the width. Where the edges tell nothing the result is the laser's.
///
/// `angle_sd_rad` is 1-sigma of the angle between the segment's sides. None for a half-hidden
/// segment, and where the laser knows a side better than to a pixel. `map` must contain
/// windows_area() of the view. Source: Bishop 2006, Pattern Recognition and Machine Learning,
/// section 2.1 (evidence of a binary variable with a uniform prior).
std::optional<PictureWidth> picture_width(const vision::EdgeMap& map, const TrunkView& view,
                                          const laser::Segment& segment, double angle_sd_rad,
                                          const Rig& rig);

}  // namespace orchard::detection
