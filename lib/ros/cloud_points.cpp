// SPDX-License-Identifier: BSD-3-Clause
#include "ros/cloud_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

namespace orchard::ros {
namespace {

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

}  // namespace

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

}  // namespace orchard::ros
