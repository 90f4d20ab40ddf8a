// SPDX-License-Identifier: BSD-3-Clause
#include "detection/trunk_view.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "vision/appearance.hpp"
#include "vision/edges.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::detection {
namespace {

/// derived: uncertainty of an object's side in the image: one beam step, which is about a pixel in
/// the middle of a typical image and more towards its sides. The exposure time adds a similar
/// uncertainty.
constexpr double kSideSpread_px = 1.5;

struct ProjectedPoint {
  Eigen::Vector2d pixel;
  double depth_m = 0.0;
};

/// Position of a static point in the laser frame after base has moved for dt_s.
PlanePoint moved(const PlanePoint& p_laser, const laser::LaserConfig& mount, const Motion& motion,
                 double dt_s) {
  const double c = std::cos(mount.mount_yaw_rad), s = std::sin(mount.mount_yaw_rad);
  const PlanePoint p_base{mount.mount_x_m + c * p_laser.x_m - s * p_laser.y_m,
                          mount.mount_y_m + s * p_laser.x_m + c * p_laser.y_m};
  const PlanePoint later = after_motion(p_base, motion, dt_s);
  const double x_m = later.x_m - mount.mount_x_m, y_m = later.y_m - mount.mount_y_m;
  return {c * x_m + s * y_m, -s * x_m + c * y_m};
}

/// Projects points of the laser frame, at their beams' times, into the image.
struct Projection {
  const Rig& rig;
  const ScanToPicture& to_picture;

  std::optional<ProjectedPoint> operator()(double range_m, double bearing_rad,
                                           std::size_t beam) const {
    const auto point = anywhere(range_m, bearing_rad, beam);
    return point && rig.camera.in_image(point->pixel) ? point : std::nullopt;
  }

  /// Projects a side of an object. A point outside the image by at most kSideSpread_px is moved to
  /// the first or last column.
  std::optional<ProjectedPoint> side(double range_m, double bearing_rad, std::size_t beam) const {
    auto point = anywhere(range_m, bearing_rad, beam);
    if (!point) return std::nullopt;
    const double last_px = rig.camera.intrinsics().width_px - 1;
    const double column_px = std::clamp(point->pixel.x(), 0.0, last_px);
    if (std::abs(point->pixel.x() - column_px) > kSideSpread_px) return std::nullopt;
    point->pixel.x() = column_px;
    return rig.camera.in_image(point->pixel) ? point : std::nullopt;
  }

  std::optional<ProjectedPoint> anywhere(double range_m, double bearing_rad,
                                         std::size_t beam) const {
    const Eigen::Vector3d p_camera = in_camera(range_m, bearing_rad, beam);
    const auto pixel = rig.camera.project(p_camera);
    return pixel ? std::optional(ProjectedPoint{*pixel, p_camera.z()}) : std::nullopt;
  }

  /// Also where the lens' distortion is not known: there without distortion.
  std::optional<Eigen::Vector2d> without_borders(double range_m, double bearing_rad,
                                                 std::size_t beam) const {
    const Eigen::Vector3d p_camera = in_camera(range_m, bearing_rad, beam);
    if (!(std::abs(p_camera.x()) < std::tan(kFieldMax_rad) * p_camera.z())) return std::nullopt;
    if (const auto pixel = rig.camera.project(p_camera)) return pixel;
    const auto& intrinsics = rig.camera.intrinsics();
    return Eigen::Vector2d(intrinsics.cc_px[0] + intrinsics.fc_px[0] * p_camera.x() / p_camera.z(),
                           intrinsics.cc_px[1] + intrinsics.fc_px[1] * p_camera.y() / p_camera.z());
  }

  Eigen::Vector3d in_camera(double range_m, double bearing_rad, std::size_t beam) const {
    PlanePoint p_laser{range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad)};
    if (to_picture.motion) {
      const double dt_s = to_picture.dt_s(static_cast<double>(beam));
      p_laser = moved(p_laser, rig.laser, *to_picture.motion, dt_s);
    }
    const Eigen::Vector2d p_plane =
        to_picture.plane_of_level * Eigen::Vector2d(p_laser.x_m, p_laser.y_m);
    return rig.T_camera_laser(Eigen::Vector3d(p_plane.x(), p_plane.y(), 0.0));
  }
};

std::optional<vision::PixelRect> window(const ProjectedPoint& point, double width_m,
                                        double height_m, const Rig& rig) {
  const auto& fc_px = rig.camera.intrinsics().fc_px;
  return vision::window_around(point.pixel.x(), point.pixel.y(), point.depth_m, width_m, height_m,
                               fc_px[0], fc_px[1], picture_of(rig), vision::tuning::kMinWindow_px);
}

}  // namespace

vision::PixelRect picture_of(const Rig& rig) {
  return {0, 0, rig.camera.intrinsics().width_px, rig.camera.intrinsics().height_px};
}

std::optional<TrunkView> view_of(const laser::Segment& segment, const Rig& rig,
                                 const ScanToPicture& to_picture) {
  const Projection project{rig, to_picture};
  const auto middle = project(segment.range_m, segment.bearing_rad, segment.middle_beam);
  auto left = project.side(segment.start_range_m, segment.start_bearing_rad, segment.first_beam);
  auto right = project.side(segment.end_range_m, segment.end_bearing_rad, segment.last_beam);
  if (!middle || !left || !right) return std::nullopt;
  if (left->pixel.x() > right->pixel.x()) std::swap(left, right);

  const vision::WindowConfig& sizes = rig.detector.window;
  const auto centre = window(*middle, sizes.colour_width_m, sizes.colour_height_m, rig);
  const auto left_edge = window(*left, sizes.edge_width_m, sizes.edge_height_m, rig);
  const auto right_edge = window(*right, sizes.edge_width_m, sizes.edge_height_m, rig);
  if (!centre || !left_edge || !right_edge) return std::nullopt;
  return TrunkView{*centre,         *left_edge,       *right_edge,
                   left->pixel.x(), right->pixel.x(), middle->pixel.y()};
}

std::optional<SidePixels> sides_of(const laser::Segment& segment, const Rig& rig,
                                   const ScanToPicture& to_picture) {
  const Projection project{rig, to_picture};
  const auto left =
      project.without_borders(segment.start_range_m, segment.start_bearing_rad, segment.first_beam);
  const auto right =
      project.without_borders(segment.end_range_m, segment.end_bearing_rad, segment.last_beam);
  if (!left || !right) return std::nullopt;
  return SidePixels{std::min(left->x(), right->x()), std::max(left->x(), right->x()),
                    0.5 * (left->y() + right->y())};
}

std::optional<Eigen::Vector2d> project_beam(double range_m, double bearing_rad, std::size_t beam,
                                            const Rig& rig, const ScanToPicture& to_picture) {
  const auto point = Projection{rig, to_picture}(range_m, bearing_rad, beam);
  if (!point) return std::nullopt;
  return point->pixel;
}

vision::PixelRect trunk_window(const TrunkView& view, const Rig& rig) {
  vision::PixelRect between = view.centre;
  between.x_px = static_cast<int>(std::lround(view.left_x_px));
  between.width_px = static_cast<int>(std::lround(view.right_x_px)) - between.x_px + 1;
  if (between.width_px < view.centre.width_px) return view.centre;
  return vision::intersection(between, picture_of(rig));
}

vision::PixelRect windows_area(const TrunkView& view, const Rig& rig) {
  const vision::PixelRect picture = picture_of(rig);
  const auto left = vision::edge_reading_area(view.left_edge, picture);
  const auto right = vision::edge_reading_area(view.right_edge, picture);
  return vision::bounding(view.centre, vision::bounding(left, right));
}

vision::PixelRect reading_area(const TrunkView& view, const Rig& rig) {
  const vision::PixelRect windows = windows_area(view, rig);
  if (rig.detector.colour_model == ColourModel::kHueInterval) return windows;
  return vision::bounding(
      windows, vision::appearance_reading_area(trunk_window(view, rig), picture_of(rig)));
}

}  // namespace orchard::detection
