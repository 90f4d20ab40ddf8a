// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include "detection/detection.hpp"
#include "laser/scan.hpp"
#include "pose/measurements.hpp"

namespace orchard::pose {

/// Any input of a localiser. Measurements with equal utime are processed in the order of the
/// alternatives: motion, then absolute poses, then trunks.
using Measurement = std::variant<Odometry, Imu, laser::Scan, PoseFix, Gnss, detection::Detections>;

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
