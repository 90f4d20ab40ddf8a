// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "detection/rig.hpp"
#include "laser/scan.hpp"
#include "vision/image.hpp"

namespace orchard::test {

/// An upright tube before the robot, in the laser frame.
struct Tube {
  double x_m, y_m, width_m;
  std::uint8_t blue, green, red;
};

inline constexpr std::uint8_t kBrown[3] = {70, 110, 160};
inline Tube brown_tube(double x_m, double y_m, double width_m = 0.09) {
  return {x_m, y_m, width_m, kBrown[0], kBrown[1], kBrown[2]};
}
inline Tube blue_tube(double x_m, double y_m, double width_m = 0.09) {
  return {x_m, y_m, width_m, 180, 110, 60};
}

inline detection::Rig tube_rig(detection::DetectorConfig detector = {}, bool has_camera = true,
                               laser::LaserConfig laser = {}) {
  geometry::CameraConfig camera;
  camera.enabled = has_camera;
  return {laser, camera, detector};
}

/// First hit of a ray from the origin with a tube, or 0.
inline double hit_m(const Tube& tube, double bearing_rad) {
  const double along = tube.x_m * std::cos(bearing_rad) + tube.y_m * std::sin(bearing_rad);
  const double across = tube.y_m * std::cos(bearing_rad) - tube.x_m * std::sin(bearing_rad);
  const double radius = 0.5 * tube.width_m;
  if (along <= 0.0 || std::abs(across) > radius) return 0.0;
  return along - std::sqrt(radius * radius - across * across);
}

/// A noiseless scan with the URG-04LX-UG01's angles; nothing but the tubes returns.
inline laser::Scan scan_of(const std::vector<Tube>& tubes, std::int64_t utime = 1'000'000) {
  laser::Scan scan;
  scan.utime = utime;
  scan.bearing_step_rad = 2.0 * 3.14159265358979323846 / 1024.0;
  scan.bearing_min_rad = -341 * scan.bearing_step_rad;
  scan.beam_period_us = 97.65625;
  scan.range_min_m = 0.02;
  scan.range_max_m = 5.6;
  for (int i = 0; i < 683; ++i) {
    double nearest_m = 0.0;
    for (const Tube& tube : tubes) {
      const double range_m = hit_m(tube, scan.bearing_rad(i));
      if (range_m > 0.0 && (nearest_m == 0.0 || range_m < nearest_m)) nearest_m = range_m;
    }
    scan.ranges_m.push_back(static_cast<float>(nearest_m));
  }
  return scan;
}

/// What the rig's undistorted camera sees of them: tubes without end before a grey wall. The tubes
/// are upright in the level frame, in which the robot is turned by R_level_laser.
inline vision::Image picture_of_tubes(
    const std::vector<Tube>& tubes, const detection::Rig& rig, std::int64_t utime = 1'000'000,
    const Eigen::Matrix3d& R_level_laser = Eigen::Matrix3d::Identity()) {
  const auto& camera = rig.camera.intrinsics();
  vision::Image image;
  image.utime = utime;
  image.width_px = camera.width_px;
  image.height_px = camera.height_px;
  image.encoding = vision::Encoding::kBgr8;
  image.data.assign(3u * static_cast<std::size_t>(camera.width_px * camera.height_px), 205);
  const auto paint = [&](const std::optional<Tube>& seen, int x, int y) {
    if (!seen) return;
    std::uint8_t* pixel = image.data.data() + 3 * (y * camera.width_px + x);
    pixel[0] = seen->blue;
    pixel[1] = seen->green;
    pixel[2] = seen->red;
  };
  const auto& T_camera_laser = rig.T_camera_laser;
  const Eigen::Vector3d eye =
      -R_level_laser * T_camera_laser.rotation().transpose() * T_camera_laser.translation_m();
  const auto seen_at = [&](int x, int y) {
    // The default extrinsics look along the laser's x axis with the image's x to the right.
    const Eigen::Vector3d ray =
        R_level_laser * Eigen::Vector3d(1.0, -(x - camera.cc_px[0]) / camera.fc_px[0],
                                        -(y - camera.cc_px[1]) / camera.fc_px[1]);
    std::optional<Tube> seen;
    double nearest_m = 1e9;
    for (Tube from_eye : tubes) {
      from_eye.x_m -= eye.x(), from_eye.y_m -= eye.y();
      const double range_m = hit_m(from_eye, std::atan2(ray.y(), ray.x()));
      if (range_m > 0.0 && range_m < nearest_m) {
        nearest_m = range_m;
        seen = from_eye;
      }
    }
    return seen;
  };
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) paint(seen_at(x, y), x, y);
  }
  return image;
}

}  // namespace orchard::test
