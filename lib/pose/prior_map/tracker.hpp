// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "pose/pose_config.hpp"
#include "pose/prior_map/local_map.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// A landmark that should be visible in a scan.
struct ExpectedLandmark {
  std::int32_t landmark = 0;
  bool seen = false;
};

/// Counts the expected trees that were observed in the last scans. It counts trees, not
/// observations, so that a felled tree counts once however long the robot stands before its stump.
class TreeDetectionMonitor {
 public:
  struct Count {
    int num_trees = 0;     ///< trees expected in several of the scans
    int num_detected = 0;  ///< of these, trees observed in at least half of those scans
  };

  void add(std::vector<ExpectedLandmark> scan);
  void clear() { scans_.clear(); }
  Count count() const;

 private:
  // derived: a second of scans, and nearly half of them.
  static constexpr std::size_t kScans = 10;
  static constexpr int kSureScans = 4;

  std::deque<std::vector<ExpectedLandmark>> scans_;
};

/// Wheel odometry over a time interval.
struct WheelStep {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
  std::array<double, 3> covariance{};  ///< var speed, cov, var yaw rate
  double dt_s = 0.0;
};

/// Tracks T_map_base by the landmarks of a prior map from a known start: an extended Kalman filter
/// over the pose and the wheels' errors (speed scale, turn scale, yaw rate bias). Observations of a
/// scan are matched one after another; each match narrows the gates of the next one.
class PriorMapTracker {
 public:
  /// Result of matching one scan to the map.
  struct Matching {
    int num_matched = 0;
    std::vector<ExpectedLandmark> expected;  ///< landmarks that should have been seen
  };

  PriorMapTracker(const PriorMap& map, const PriorMapConfig& config);

  /// Sets the pose; keeps the estimates of the wheels' errors.
  void start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);

  void move(const WheelStep& step);
  /// Predicts a motion of base that was not measured by wheels.
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance);
  Matching correct(const std::vector<ScanObservation>& observations, const FieldOfView& field);

  Eigen::Vector3d T_map_base() const { return x_.head<3>(); }
  Eigen::Matrix3d covariance() const { return P_.topLeftCorner<3, 3>(); }

  /// Returns the motion T_before_after of a step, corrected for the estimated wheel errors.
  Eigen::Vector3d motion(const WheelStep& step) const;
  /// Returns the covariance of motion() for users that do not estimate the wheel errors: their
  /// uncertainty is added as white noise with the same effect over a headland turn.
  Eigen::Matrix3d motion_covariance(const WheelStep& step) const;

 private:
  using State = Eigen::Matrix<double, 6, 1>;  ///< x, y, yaw, speed scale, turn scale, yaw rate bias
  using Covariance = Eigen::Matrix<double, 6, 6>;

  struct Match {
    std::int32_t landmark = -1;
    double d2 = 0.0;
    Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
  };
  Eigen::Matrix3d noise(const WheelStep& step) const;
  Match best_match(const ScanObservation& observation,
                   const std::vector<std::int32_t>& taken) const;
  void update(const ScanObservation& observation, const Match& match);
  Eigen::Matrix<double, 2, 6> jacobian(const ScanObservation& observation) const;

  const PriorMap& map_;
  PriorMapConfig config_;
  State x_ = State::Zero();
  Covariance P_ = Covariance::Zero();
};

}  // namespace orchard::pose
