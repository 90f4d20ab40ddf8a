// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "pose/gnss_config.hpp"
#include "pose/measurements.hpp"

namespace orchard::pose {

/// Position of the antenna in the east-north plane of the datum, from one fix.
struct GnssPosition {
  std::int64_t utime = 0;
  Eigen::Vector2d p_enu_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< [m2], at least that of its quality
};

/// Converts fixes to metres east and north of a datum.
///
/// The datum is the configured one, or the first usable fix. A fix of quality 0 (NMEA: no fix) is
/// not usable. Variances are those stated by the fix, but at least those configured for its
/// quality.
class GnssPositions {
 public:
  explicit GnssPositions(const GnssConfig& config);
  ~GnssPositions();
  GnssPositions(GnssPositions&&) noexcept;
  GnssPositions& operator=(GnssPositions&&) noexcept;

  /// Converts a fix; none if it is not usable.
  std::optional<GnssPosition> add(const Gnss& gnss);

  /// Returns latitude [deg], longitude [deg], altitude [m] of the datum; none before the first
  /// usable fix if no datum is configured.
  std::optional<std::array<double, 3>> datum() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::pose
