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

/// Projection of a laser segment into the image: its windows and expected edges.
struct TrunkView {
  vision::PixelRect centre;     ///< colour window around the middle
  vision::PixelRect left_edge;  ///< edge windows around P_start and P_end
  vision::PixelRect right_edge;
  double left_x_px = 0.0;  ///< columns of the edges expected by the laser
  double right_x_px = 0.0;
  double row_px = 0.0;  ///< of the middle
};

/// The whole image of the rig's camera.
vision::PixelRect picture_of(const Rig& rig);

/// Projects a segment's P_start, P_end and middle into the image and places windows around them.
/// Each point is first moved from its own beam's time to the exposure. None if the
/// segment is not fully in view or too small in the image.
/// Source: Shalal et al. 2013, sections 3.3 and 4.2.
std::optional<TrunkView> view_of(const laser::Segment& segment, const Rig& rig,
                                 const ScanToPicture& to_picture = {});

/// Where an object's two sides and the scan's plane are expected, also outside the image.
struct SidePixels {
  double left_x_px = 0.0;
  double right_x_px = 0.0;
  double row_px = 0.0;
};

/// Projects the sides of a segment as view_of() does, without the image's borders. None for what is
/// more than kFieldMax_rad from the camera's axis.
std::optional<SidePixels> sides_of(const laser::Segment& segment, const Rig& rig,
                                   const ScanToPicture& to_picture = {});

/// derived: wider lenses are no pinhole cameras.
inline constexpr double kFieldMax_rad = 1.2;

/// Projects a point of the scan to its column and row in the image, with motion as in view_of().
/// None outside the image.
std::optional<Eigen::Vector2d> project_beam(double range_m, double bearing_rad, std::size_t beam,
                                            const Rig& rig, const ScanToPicture& to_picture);

/// The window judged by `colour_model: appearance`: between the two expected edges, over the colour
/// window's rows and at least as wide as that window. Inside the image.
vision::PixelRect trunk_window(const TrunkView& view, const Rig& rig);

/// The area of the image that contains all windows of a view, with the padding for edge detection.
vision::PixelRect windows_area(const TrunkView& view, const Rig& rig);

/// The area of the image that judge_by_camera() reads for a view.
vision::PixelRect reading_area(const TrunkView& view, const Rig& rig);

}  // namespace orchard::detection
