// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
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

/// What the rig's undistorted camera sees of them: tubes without end before a grey wall.
inline vision::Image picture_of_tubes(const std::vector<Tube>& tubes, const detection::Rig& rig,
                                      std::int64_t utime = 1'000'000) {
  const auto& camera = rig.camera.intrinsics();
  vision::Image image;
  image.utime = utime;
  image.width_px = camera.width_px;
  image.height_px = camera.height_px;
  image.encoding = vision::Encoding::kBgr8;
  image.data.assign(3u * static_cast<std::size_t>(camera.width_px * camera.height_px), 205);
  for (int x = 0; x < camera.width_px; ++x) {
    // The default extrinsics look along the laser's x axis with the image's x to the right.
    const double bearing_rad = -std::atan((x - camera.cc_px[0]) / camera.fc_px[0]);
    const Tube* seen = nullptr;
    double nearest_m = 1e9;
    for (const Tube& tube : tubes) {
      const double range_m = hit_m(tube, bearing_rad);
      if (range_m > 0.0 && range_m < nearest_m) {
        nearest_m = range_m;
        seen = &tube;
      }
    }
    if (!seen) continue;
    for (int y = 0; y < camera.height_px; ++y) {
      std::uint8_t* pixel = image.data.data() + 3 * (y * camera.width_px + x);
      pixel[0] = seen->blue;
      pixel[1] = seen->green;
      pixel[2] = seen->red;
    }
  }
  return image;
}

}  // namespace orchard::test
