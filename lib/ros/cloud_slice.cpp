// SPDX-License-Identifier: BSD-3-Clause
#include "ros/cloud_slice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "geometry/angles.hpp"
#include "ros/ros_messages.hpp"

namespace orchard::ros {
namespace {

/// One point of a cloud, with the properties needed for a slice.
struct CloudPoint {
  double bearing_rad = 0.0;
  double range_m = 0.0;  ///< in the plane
  double z_m = 0.0;
  double time_s = 0.0;     ///< time after the cloud's stamp
  std::uint32_t line = 0;  ///< scanner line (ring); 0 when the cloud has none
};

struct CloudPoints {
  std::vector<CloudPoint> points;  ///< finite and not at the origin, in the cloud's order
  bool has_time = false;
  bool has_lines = false;
};

constexpr double kMaxSeconds = 10.0;  // longer than any sweep

/// Reads one field of each point; the field must lie within the point.
class FieldReader {
 public:
  FieldReader(const PointCloud& cloud, std::string_view name) : is_big_(cloud.is_big_endian) {
    for (const PointField& field : cloud.fields) {
      if (field.name != name) continue;
      const std::size_t size = size_of(field.datatype);
      if (size == 0 || std::uint64_t{field.offset} + size > cloud.point_bytes) continue;
      field_ = field;
      size_ = size;
    }
  }

  bool is_there() const { return size_ > 0; }
  std::uint8_t datatype() const { return field_.datatype; }

  double of(const std::uint8_t* point) const {
    std::uint8_t bytes[8] = {};
    std::memcpy(bytes, point + field_.offset, size_);
    if (is_big_) std::reverse(bytes, bytes + size_);
    switch (field_.datatype) {
      case 1:
        return as<std::int8_t>(bytes);
      case 2:
        return as<std::uint8_t>(bytes);
      case 3:
        return as<std::int16_t>(bytes);
      case 4:
        return as<std::uint16_t>(bytes);
      case 5:
        return as<std::int32_t>(bytes);
      case 6:
        return as<std::uint32_t>(bytes);
      case 7:
        return static_cast<double>(as<float>(bytes));
      default:
        return as<double>(bytes);
    }
  }

 private:
  static std::size_t size_of(std::uint8_t datatype) {
    constexpr std::size_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return datatype < std::size(kSizes) ? kSizes[datatype] : 0;
  }
  template <class T>
  static T as(const std::uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  PointField field_;
  std::size_t size_ = 0;
  bool is_big_;
};

/// Reads the time of a point; drivers use three names and units for it.
class TimeReader {
 public:
  explicit TimeReader(const PointCloud& cloud)
      : time_(cloud, "time"),
        t_(cloud, "t"),
        timestamp_(cloud, "timestamp"),
        stamp_s_(1e-6 * static_cast<double>(cloud.utime)) {}

  bool is_there() const {
    return time_.is_there() || t_.is_there() || timestamp_.datatype() == kDouble;
  }

  /// Time after the cloud's stamp [s].
  double of(const std::uint8_t* point) const {
    constexpr double kSecondsPerNanosecond = 1e-9;
    if (time_.is_there()) return time_.of(point);
    if (t_.is_there()) return t_.of(point) * kSecondsPerNanosecond;
    return timestamp_.of(point) - stamp_s_;
  }

 private:
  static constexpr std::uint8_t kDouble = 8;  // single precision cannot hold an absolute time
  FieldReader time_, t_, timestamp_;
  double stamp_s_;
};

constexpr std::size_t kMinPoints = 20;
constexpr double kMinStep_rad = 2e-4;  // finer than any scanner; below: points of two lines
constexpr double kMaxStep_rad = 0.1;
constexpr double kTurn_rad = 2.0 * geometry::kPi;
constexpr double kFarthest_m = 100.0;

using Line = std::vector<CloudPoint>;

/// The scanner line with the most points between two heights.
Line longest_line(const CloudPoints& cloud, double low_m, double high_m) {
  std::map<std::uint32_t, Line> lines;
  for (const CloudPoint& point : cloud.points) {
    if (point.z_m >= low_m && point.z_m <= high_m) lines[point.line].push_back(point);
  }
  Line longest;
  for (auto& [number, line] : lines) {
    if (line.size() > longest.size()) longest = std::move(line);
  }
  return longest;
}

/// The step between a line's bearings [rad]; none if it cannot be determined.
std::optional<double> step_of(const Line& line) {
  std::vector<double> bearings_rad, gaps_rad;
  for (const CloudPoint& point : line) bearings_rad.push_back(point.bearing_rad);
  std::sort(bearings_rad.begin(), bearings_rad.end());
  for (std::size_t i = 1; i < bearings_rad.size(); ++i) {
    const double gap_rad = bearings_rad[i] - bearings_rad[i - 1];
    if (gap_rad > kMinStep_rad) gaps_rad.push_back(gap_rad);
  }
  if (gaps_rad.size() + 1 < kMinPoints) return std::nullopt;
  const auto middle = gaps_rad.begin() + static_cast<std::ptrdiff_t>(gaps_rad.size() / 2);
  std::nth_element(gaps_rad.begin(), middle, gaps_rad.end());
  const double median_rad = *middle;
  if (median_rad > kMaxStep_rad) return std::nullopt;
  // The mean over many steps is more accurate than one step. All gaps count, since noise in a
  // bearing shortens one gap and lengthens its neighbour.
  double sum_rad = 0.0, num_steps = 0.0;
  for (std::size_t i = 1; i < bearings_rad.size(); ++i) {
    const double gap_rad = bearings_rad[i] - bearings_rad[i - 1];
    const double steps = std::round(gap_rad / median_rad);
    if (steps > 3.0) continue;
    sum_rad += gap_rad;
    num_steps += steps;
  }
  return sum_rad / num_steps;
}

/// Direction of rotation and time between beams, from the points of a line in order of time.
struct Turn {
  double direction = 1.0;
  double beam_period_us = 0.0;
};
Turn turn_of(const Line& in_time, double step_rad) {
  int num_left = 0, num_right = 0;
  double time_s = 0.0, steps = 0.0;
  for (std::size_t i = 1; i < in_time.size(); ++i) {
    const double turned_rad =
        geometry::wrap_angle_rad(in_time[i].bearing_rad - in_time[i - 1].bearing_rad);
    (turned_rad > 0 ? num_left : num_right) += 1;
    const double num = std::round(std::abs(turned_rad) / step_rad);
    if (num < 1.0 || num > 3.0) continue;
    time_s += in_time[i].time_s - in_time[i - 1].time_s;
    steps += num;
  }
  Turn turn;
  turn.direction = num_left >= num_right ? 1.0 : -1.0;
  if (steps > 0.0) turn.beam_period_us = std::max(0.0, 1e6 * time_s / steps);
  return turn;
}

/// Mean offset of a line's bearings from the beams that begin at `first_rad`.
double phase_of(const Line& line, double first_rad, double step_rad) {
  double sine = 0.0, cosine = 0.0;
  for (const CloudPoint& point : line) {
    const double phase = kTurn_rad * (point.bearing_rad - first_rad) / step_rad;
    sine += std::sin(phase);
    cosine += std::cos(phase);
  }
  return std::atan2(sine, cosine) / kTurn_rad * step_rad;
}

/// Sets beams to NaN that are far in bearing from all points of the cloud at any height: the
/// scanner's field of view does not include them.
void forget_unseen(const CloudPoints& cloud, laser::Scan& scan) {
  constexpr double kSector_rad = kTurn_rad / 36;  // coarse: some directions have no points
  std::vector<bool> is_seen(36, false);
  for (const CloudPoint& point : cloud.points) {
    const auto sector = static_cast<int>((point.bearing_rad + geometry::kPi) / kSector_rad);
    is_seen[static_cast<std::size_t>(std::clamp(sector, 0, 35))] = true;
  }
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double bearing_rad = geometry::wrap_angle_rad(scan.bearing_rad(static_cast<double>(i)));
    const auto sector = static_cast<int>((bearing_rad + geometry::kPi) / kSector_rad);
    if (!is_seen[static_cast<std::size_t>(std::clamp(sector, 0, 35))]) {
      scan.ranges_m[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

/// Reads the points of a cloud; none when it has no fields x, y and z.
std::optional<CloudPoints> read_points(const PointCloud& cloud) {
  const FieldReader x(cloud, "x"), y(cloud, "y"), z(cloud, "z"), ring(cloud, "ring");
  if (!x.is_there() || !y.is_there() || !z.is_there()) return std::nullopt;
  const TimeReader time(cloud);
  CloudPoints result;
  result.has_time = time.is_there();
  result.has_lines = ring.is_there() || cloud.height > 1;
  // An ordered cloud has its scanner lines along the longer side.
  const bool rows_are_lines = cloud.width >= cloud.height;
  for (std::uint32_t row = 0; row < cloud.height; ++row) {
    for (std::uint32_t column = 0; column < cloud.width; ++column) {
      const std::uint8_t* bytes =
          cloud.data + std::size_t{row} * cloud.row_bytes + std::size_t{column} * cloud.point_bytes;
      const double x_m = x.of(bytes), y_m = y.of(bytes);
      CloudPoint point;
      point.z_m = z.of(bytes);
      point.range_m = std::hypot(x_m, y_m);
      if (!std::isfinite(point.range_m) || !std::isfinite(point.z_m) || point.range_m <= 0.0) {
        continue;
      }
      point.bearing_rad = std::atan2(y_m, x_m);
      if (result.has_time) {
        point.time_s = time.of(bytes);
        if (!(std::abs(point.time_s) < kMaxSeconds)) result.has_time = false;
      }
      if (ring.is_there()) {
        const double number = ring.of(bytes);
        point.line = number >= 0 && number < 65536 ? static_cast<std::uint32_t>(number) : 0;
      } else if (cloud.height > 1) {
        point.line = rows_are_lines ? row : column;
      }
      result.points.push_back(point);
    }
  }
  return result;
}

}  // namespace

std::variant<laser::Scan, NotUsed> slice_cloud(const PointCloud& cloud, const CloudSlice& slice) {
  const auto points = read_points(cloud);
  if (!points) return NotUsed{"a cloud without fields x, y and z"};
  const double low_m = slice.height_m - slice.thickness_m / 2;
  const double high_m = slice.height_m + slice.thickness_m / 2;
  Line line = longest_line(*points, low_m, high_m);
  // All lines have the same step, and one that meets the ground has the most points for it.
  constexpr double kAnyHeight_m = std::numeric_limits<double>::infinity();
  const std::optional<double> step_rad =
      points->has_lines ? step_of(longest_line(*points, -kAnyHeight_m, kAnyHeight_m))
                        : step_of(line);
  if (!step_rad || line.size() < kMinPoints)
    return NotUsed{"a slice with fewer than 20 points of one line"};

  laser::Scan scan;
  scan.utime = cloud.utime;
  scan.range_max_m = kFarthest_m;
  scan.bearing_min_rad = -geometry::kPi;
  scan.bearing_step_rad = *step_rad;
  if (points->has_time) {
    const auto earlier = [](const CloudPoint& a, const CloudPoint& b) {
      return a.time_s < b.time_s;
    };
    std::stable_sort(line.begin(), line.end(), earlier);
    const Turn turn = turn_of(line, *step_rad);
    const CloudPoint& first =
        *std::min_element(points->points.begin(), points->points.end(), earlier);
    scan.bearing_min_rad = first.bearing_rad;
    scan.bearing_step_rad *= turn.direction;
    scan.beam_period_us = turn.beam_period_us;
    scan.utime += static_cast<std::int64_t>(std::llround(1e6 * first.time_s));
  }
  scan.bearing_min_rad += phase_of(line, scan.bearing_min_rad, *step_rad);
  const auto num_beams = static_cast<std::size_t>(kTurn_rad / *step_rad + 0.5);
  scan.ranges_m.assign(num_beams, 0.0f);
  for (const CloudPoint& point : points->points) {
    if (point.z_m < low_m || point.z_m > high_m || point.range_m > kFarthest_m) continue;
    const double direction = scan.bearing_step_rad > 0 ? 1.0 : -1.0;
    double turned_rad = direction * (point.bearing_rad - scan.bearing_min_rad);
    turned_rad -= std::floor(turned_rad / kTurn_rad) * kTurn_rad;
    const auto beam = static_cast<std::size_t>(turned_rad / *step_rad + 0.5);
    // A bearing just before the first beam belongs to it.
    float& range_m = scan.ranges_m[beam < num_beams ? beam : 0];
    const auto this_m = static_cast<float>(point.range_m);
    if (range_m == 0.0f || this_m < range_m) range_m = this_m;
  }
  forget_unseen(*points, scan);
  return scan;
}

}  // namespace orchard::ros
