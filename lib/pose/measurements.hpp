// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "detection/detection.hpp"
#include "laser/scan.hpp"

namespace orchard::pose {

/// Velocity of base from wheel encoders: the mean since the previous reading.
struct Odometry {
  std::int64_t utime = 0;  ///< end of the interval [us]
  std::int32_t seq = 0;
  double speed_mps = 0.0;              ///< along base x
  double yaw_rate_radps = 0.0;         ///< about base z
  std::array<double, 3> covariance{};  ///< var speed [m2/s2], cov, var yaw rate [rad2/s2]
};

/// Upward variance from which on a fix's altitude counts as unknown [m2]. physical: 100 m, worse
/// than any fix in space.
inline constexpr double kUnknownAltitudeVariance_m2 = 1e4;

/// One satellite fix, WGS84.
struct Gnss {
  std::int64_t utime = 0;  ///< time of the fix [us]
  std::int32_t seq = 0;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;             ///< above the ellipsoid
  std::array<double, 6> covariance{};  ///< ENU [m2]: ee en eu nn nu uu; all 0 = unknown
  std::int8_t fix_quality = 1;         ///< NMEA GGA quality
};

/// Pose of base in map from an external source.
struct PoseFix {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;                ///< valid if has_yaw
  std::array<double, 6> covariance{};  ///< of (x, y, yaw): xx xy xyaw yy yyaw yawyaw
  bool has_yaw = true;
};

/// One sample of an IMU, in the axes of base (x forward, y left, z up).
struct Imu {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::array<double, 3> angular_rate_radps{};
  std::array<double, 3> acceleration_mps2{};  ///< specific force: (0, 0, +9.8) at rest
  double angular_rate_variance = 0.0;         ///< of each axis [rad2/s2]; 0 = unknown
  double acceleration_variance = 0.0;         ///< of each axis [m2/s4]; 0 = unknown
  double roll_rad = 0.0;                      ///< of base; valid if has_orientation
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;               ///< from east, or from the heading at power-on
  double orientation_variance = 0.0;  ///< of each angle [rad2]; 0 = unknown
  bool has_orientation = false;
};

/// Any input of a localiser. Measurements with equal utime are processed in the order of the
/// alternatives: motion, then absolute poses, then trunks.
using Measurement = std::variant<Odometry, Imu, laser::Scan, PoseFix, Gnss, detection::Detections>;

/// derived: from the list above.
inline constexpr std::size_t kNumMeasurementKinds = std::variant_size_v<Measurement>;

/// Index of an alternative of Measurement.
enum class MeasurementKind : std::size_t { kOdometry, kImu, kScan, kPoseFix, kGnss, kDetections };

/// Max time to wait for a late kind of measurement [s of message time], indexed by MeasurementKind;
/// none for a kind that is not expected.
using MeasurementWaits = std::array<std::optional<double>, kNumMeasurementKinds>;

inline MeasurementKind kind_of(const Measurement& measurement) {
  return static_cast<MeasurementKind>(measurement.index());
}

/// Returns the time of any measurement [us].
inline std::int64_t utime_of(const Measurement& measurement) {
  return std::visit([](const auto& m) { return m.utime; }, measurement);
}

}  // namespace orchard::pose
