// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "detection/rig.hpp"
#include "geometry/pose2.hpp"
#include "laser/scan.hpp"
#include "vision/image.hpp"

namespace orchard::view {

/// A picture as a browser takes it.
struct ShownPicture {
  std::int64_t utime = 0;
  const char* type = "image/jpeg";  ///< or image/bmp
  std::string bytes;
};

ShownPicture shown_picture(const vision::Image& image);

/// `[x, y, x, y ...]` in metres, to the centimetre, from point `from` on.
std::string points_json(const std::vector<Eigen::Vector2d>& points, std::size_t from);

/// The same of a scan's returns, in map.
std::string scan_points_json(const laser::Scan& scan, const geometry::Pose2& T_map_base,
                             const detection::Rig& rig);

/// What was made of a picture, without braces: "picture" (how to ask for it), "width", "height",
/// "trunks" [{"label", "centre", "left_edge", "right_edge" [x, y, width, height in pixels],
/// "range", "laser" ... every confidence}].
std::string look_json(const detection::Detections& detections, const detection::Rig& rig,
                      const std::string& picture);

}  // namespace orchard::view
