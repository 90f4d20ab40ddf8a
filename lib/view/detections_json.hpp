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

/// Converts a raw image (BGR8 or GRAY8 with the number of bytes of its size) to a 24-bit Windows
/// bitmap, which browsers display. Empty for any other image.
std::string bitmap(const vision::Image& image);

/// An image in a format for browsers.
struct ShownPicture {
  std::int64_t utime = 0;
  const char* type = "image/jpeg";  ///< or image/bmp
  std::string bytes;
};

ShownPicture shown_picture(const vision::Image& image);

/// Formats points as `[x, y, x, y ...]` in metres, rounded to the centimetre, starting at index
/// `from`.
std::string points_json(const std::vector<Eigen::Vector2d>& points, std::size_t from);

/// The same for the returns of a scan, in map.
std::string scan_points_json(const laser::Scan& scan, const geometry::Pose2& T_map_base,
                             const detection::Rig& rig);

/// Formats the detections of an image, without braces: "picture" (its URL), "width", "height",
/// "trunks" [{"label", "centre", "left_edge", "right_edge" [x, y, width, height in pixels],
/// "range", "laser" ... all confidences}].
std::string detections_json(const detection::Detections& detections, const detection::Rig& rig,
                            const std::string& picture);

}  // namespace orchard::view
