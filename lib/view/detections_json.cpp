// SPDX-License-Identifier: BSD-3-Clause
#include "view/detections_json.hpp"

#include <fmt/core.h>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "detection/trunk_view.hpp"
#include "text/number_text.hpp"
#include "view/map_data.hpp"

namespace orchard::view {
namespace {

/// Little-endian, as required by the format.
void add_number(std::string& bytes, std::uint32_t value, int num_bytes) {
  for (int k = 0; k < num_bytes; ++k) bytes += static_cast<char>(value >> (8 * k));
}

/// Image window in which the camera looks for a detection: a segment of its width as seen from the
/// laser.
std::optional<detection::TrunkView> window_of(const detection::Detection& d,
                                              const detection::Rig& rig) {
  laser::Segment segment;
  segment.range_m = segment.start_range_m = segment.end_range_m = d.range_m;
  segment.bearing_rad = d.bearing_rad;
  const double half_rad = std::atan2(0.5 * d.width_m, d.range_m + 0.5 * d.width_m);
  segment.start_bearing_rad = d.bearing_rad - half_rad;
  segment.end_bearing_rad = d.bearing_rad + half_rad;
  return detection::view_of(segment, rig);
}

std::string rect_text(const vision::PixelRect& rect) {
  return fmt::format("[{},{},{},{}]", rect.x_px, rect.y_px, rect.width_px, rect.height_px);
}

}  // namespace

std::string bitmap(const vision::Image& image) {
  const bool is_gray = image.encoding == vision::Encoding::kGray8;
  if (image.encoding == vision::Encoding::kJpeg || image.width_px <= 0 || image.height_px <= 0) {
    return {};
  }
  const auto wide = static_cast<std::size_t>(image.width_px);
  const auto high = static_cast<std::size_t>(image.height_px);
  if (image.data.size() != wide * high * (is_gray ? 1 : 3)) return {};
  const std::size_t padding = (4 - 3 * wide % 4) % 4;
  constexpr std::size_t kHeader = 54;
  const std::size_t size = kHeader + high * (3 * wide + padding);
  std::string bytes = "BM";
  bytes.reserve(size);
  add_number(bytes, static_cast<std::uint32_t>(size), 4);
  add_number(bytes, 0, 4);
  add_number(bytes, kHeader, 4);
  add_number(bytes, 40, 4);  // size of the following header
  add_number(bytes, static_cast<std::uint32_t>(wide), 4);
  add_number(bytes, static_cast<std::uint32_t>(high), 4);
  add_number(bytes, 1, 2);   // planes
  add_number(bytes, 24, 2);  // bits per pixel
  for (int k = 0; k < 6; ++k) add_number(bytes, 0, 4);
  for (std::size_t row = high; row-- > 0;) {  // bottom row first
    for (std::size_t k = row * wide; k < (row + 1) * wide; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        bytes += static_cast<char>(image.data[is_gray ? k : 3 * k + c]);
      }
    }
    bytes.append(padding, '\0');
  }
  return bytes;
}

std::string points_json(const std::vector<Eigen::Vector2d>& points, std::size_t from) {
  std::string text = "[";
  for (std::size_t k = from; k < points.size(); ++k) {
    if (text.size() > 1) text += ',';
    text += fixed_text(points[k].x(), 2) + "," + fixed_text(points[k].y(), 2);
  }
  return text + "]";
}

std::string scan_points_json(const laser::Scan& scan, const geometry::Pose2& T_map_base,
                             const detection::Rig& rig) {
  const geometry::Pose2 T_base_laser{rig.laser.mount_x_m, rig.laser.mount_y_m,
                                     rig.laser.mount_yaw_rad};
  std::vector<Eigen::Vector2d> points;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (!scan.valid(beam)) continue;
    const double range_m = scan.ranges_m[beam];
    const double bearing_rad = scan.bearing_rad(static_cast<double>(beam));
    const Eigen::Vector2d p_laser(range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad));
    points.push_back(geometry::transform(T_map_base, geometry::transform(T_base_laser, p_laser)));
  }
  return points_json(points, 0);
}

std::string detections_json(const detection::Detections& detections, const detection::Rig& rig,
                            const std::string& picture) {
  std::string trunks;
  for (const detection::Detection& d : detections.trunks) {
    const auto window = window_of(d, rig);
    if (!window) continue;
    trunks += fmt::format(R"({}{{"label":{},"centre":{},"left_edge":{},"right_edge":{},"range":{})",
                          trunks.empty() ? "" : ",", label_number(d.label),
                          rect_text(window->centre), rect_text(window->left_edge),
                          rect_text(window->right_edge), fixed_text(d.range_m, 2));
    const std::pair<const char*, float> rocs[] = {
        {"laser", d.roc_laser},      {"colour", d.roc_colour},     {"left", d.roc_left_edge},
        {"right", d.roc_right_edge}, {"parallel", d.roc_parallel}, {"edges", d.roc_edges},
        {"vision", d.roc_vision},    {"tree", d.roc_tree}};
    for (const auto& [name, roc] : rocs) {
      trunks += fmt::format(R"(,"{}":{})", name, fixed_text(roc, 3));
    }
    trunks += "}";
  }
  const vision::PixelRect whole = detection::picture_of(rig);
  return fmt::format(R"("picture":"{}","width":{},"height":{},"trunks":[{}])", picture,
                     whole.width_px, whole.height_px, trunks);
}

ShownPicture shown_picture(const vision::Image& image) {
  ShownPicture picture;
  picture.utime = image.utime;
  if (image.encoding == vision::Encoding::kJpeg) {
    picture.bytes.assign(image.data.begin(), image.data.end());
  } else {
    picture.type = "image/bmp";
    picture.bytes = bitmap(image);
  }
  return picture;
}

}  // namespace orchard::view
