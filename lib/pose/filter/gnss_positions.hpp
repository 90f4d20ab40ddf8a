// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "pose/filter/gnss_config.hpp"
#include "pose/measurements.hpp"

namespace orchard::pose {

/// Where a fix puts the antenna in the east-north plane of the datum.
struct GnssPosition {
  std::int64_t utime = 0;
  Eigen::Vector2d p_enu_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< [m2], never below its quality's

  template <class Archive>
  void persist(Archive& archive) {
    archive(utime, p_enu_m, covariance);
  }
};

/// Fixes in metres east and north of a datum.
///
/// The datum is the configured one, or the first usable fix. A fix without quality (NMEA 0) is not
/// usable. Covariances are as stated, but not below what the fix's quality is believed to reach;
/// that alone where none is stated.
class GnssPositions {
 public:
  explicit GnssPositions(const GnssConfig& config);
  ~GnssPositions();
  GnssPositions(GnssPositions&&) noexcept;
  GnssPositions& operator=(GnssPositions&&) noexcept;

  /// None for a fix that cannot be used.
  std::optional<GnssPosition> add(const Gnss& gnss);

  /// Latitude [deg], longitude [deg], altitude [m]; none before the first usable fix of a
  /// receiver without a configured one.
  std::optional<std::array<double, 3>> datum() const;
  /// Goes on with the datum of another one.
  void set_datum(const std::array<double, 3>& datum);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::pose
