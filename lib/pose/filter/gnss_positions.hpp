// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pose/measurements.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Position of the antenna in the east-north plane of the datum, from one fix.
struct GnssPosition {
  std::int64_t utime = 0;
  Eigen::Vector2d p_enu_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< [m2], at least that of its quality
  double height_m = 0.0;                                     ///< along the ellipsoid's normal
  double height_variance_m2 = 0.0;  ///< at least that of its quality; 0 = height unknown
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

/// Detects undeclared faults of a receiver from the motion between its fixes: repeated identical
/// fixes (frozen), and more scatter than claimed.
class GnssMonitor {
 public:
  /// Adds a fix and the travel since the last one [m]. Returns true if the receiver is frozen: it
  /// has repeated the same position exactly over more than kFreezeTravel_m.
  bool is_frozen_at(const Gnss& gnss, double travel_m);

  /// Adds the difference between the step of two fixes and the motion between them [m].
  void add_step_error(const Eigen::Vector2d& error_m);

  /// Returns the standard deviation of fixes per axis [m], estimated from the median of the last
  /// steps, so that a jump does not count. None before there are enough steps.
  std::optional<double> scatter_m() const;

 private:
  static constexpr std::size_t kNumSteps = 31;  // derived: 6 s at 5 Hz

  std::optional<Gnss> first_same_;          ///< first of the latest identical fixes
  double travel_m_ = 0.0;                   ///< travel since first_same_
  std::array<double, kNumSteps> steps2_{};  ///< squared errors of the last steps [m2]
  std::size_t num_steps_ = 0;
};

/// Positions of the antenna at one fix: measured in the datum's east-north plane, and estimated in
/// map.
struct AntennaObservation {
  Eigen::Vector2d p_enu_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d p_map_m = Eigen::Vector2d::Zero();
  double variance_m2 = 1.0;  ///< of the fix, per axis
};

/// Pose of a map in the datum's east-north plane.
struct GnssAlignment {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();  ///< T_enu_map
  double residual_rms_m = 0.0;                        ///< of the fixes used
  int num_used = 0;
  int num_left_out = 0;  ///< outliers, e.g. jumps
  /// Fixes, of all, that are farther from the path than three of their standard deviations and
  /// kGeoreferenceResidualMax_m; and their median distance [m].
  int num_contradicting = 0;
  double contradicting_m = 0.0;
};

/// Finds the rigid transform that registers the robot's path in map to its satellite fixes,
/// weighted by inverse variance and without outliers (residuals above four times the median and
/// three standard deviations). None for fewer than ten fixes, or if they spread too little to
/// determine a heading: by less than 5 m, or than twenty standard errors of their mean.
std::optional<GnssAlignment> align_to_gnss(const std::vector<AntennaObservation>& observations);

}  // namespace orchard::pose
