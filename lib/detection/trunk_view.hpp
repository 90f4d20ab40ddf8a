// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "detection/motion.hpp"
#include "detection/rig.hpp"
#include "laser/segment.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::detection {

/// Where a laser segment stands in the picture, and the windows to look at.
struct TrunkView {
  vision::PixelRect centre;     ///< colour window around the middle
  vision::PixelRect left_edge;  ///< edge windows around P_start and P_end
  vision::PixelRect right_edge;
  double left_x_px = 0.0;  ///< columns at which the laser expects the edges
  double right_x_px = 0.0;
};

/// The whole picture of the rig's camera.
vision::PixelRect picture_of(const Rig& rig);

/// Projects a segment's P_start, P_end and middle into the picture and lays windows around them.
/// With a motion, each point first moves on from its own beam's time to the picture's exposure.
/// None when the camera has no full view of it: behind or beside the picture, or too small in it.
/// Source: Shalal et al. 2013, sections 3.3 and 4.2.
std::optional<TrunkView> view_of(const laser::Segment& segment, const Rig& rig,
                                 const std::optional<ScanToPicture>& motion = std::nullopt);

/// The column and row at which the camera sees a point of the scan, moved as view_of() does. None
/// outside the picture.
std::optional<Eigen::Vector2d> project_beam(double range_m, double bearing_rad, std::size_t beam,
                                            const Rig& rig,
                                            const std::optional<ScanToPicture>& motion);

/// The window between the two edges that the laser expects, over the colour window's rows and at
/// least as wide: what `colour_model: appearance` judges. Inside the picture.
vision::PixelRect trunk_window(const TrunkView& view, const Rig& rig);

/// The part of the picture in which its windows lie, with the border that their edges need.
vision::PixelRect windows_area(const TrunkView& view, const Rig& rig);

/// The part of the picture that judging the trunk reads.
vision::PixelRect reading_area(const TrunkView& view, const Rig& rig);

}  // namespace orchard::detection
