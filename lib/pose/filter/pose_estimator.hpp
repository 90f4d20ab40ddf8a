// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::pose {

/// T_map_base from fixes and wheel odometry, with its covariance: an extended Kalman filter over
/// (x, y, yaw) whose prediction is MRPT's composition of Gaussian poses.
///
/// Takes measurements in order of time; a pure function of that sequence. Without odometry every
/// fix is a pose of its own, as the paper places its robot by hand (Shalal et al. 2013, section
/// 6.1). Fixes without yaw give no pose until the robot has travelled heading_baseline_m.
class PoseEstimator : public Localiser {
 public:
  explicit PoseEstimator(const PoseConfig& config);

  void add(const Measurement& measurement) override;

  /// Dead-reckons to the odometry's time by what it says of the way since the one before; a silence
  /// longer than odometry_gap_max_s forgets the pose until the next fix (in mode odometry, which
  /// has none: the robot is taken to have stood, and the silence is counted).
  void add(const Odometry& odometry);

  /// Dead-reckons to the fix's time with the last velocity, then corrects.
  void add(const PoseFix& fix);

  /// The pose at the time of the last measurement; none while it is unknown.
  std::optional<PoseEstimate> estimate() const override;

  /// The way to the first known pose, from the odometry that came before it, backwards: at most
  /// kPastMax_us of it, without a silence.
  std::vector<PoseEstimate> take_past() override { return std::exchange(past_, {}); }

  static constexpr std::int64_t kPastMax_us = 60'000'000;

  std::int64_t num_gaps() const { return num_gaps_; }

 private:
  struct State {
    std::int64_t utime = 0;
    Eigen::Vector3d mean;  ///< x, y, yaw
    Eigen::Matrix3d covariance;
  };

  void predict_to(std::int64_t utime, double speed_mps, double yaw_rate_radps,
                  const std::array<double, 3>& velocity_covariance);
  static void move(State& state, double speed_mps, double yaw_rate_radps, double dt_s,
                   const std::array<double, 3>& velocity_covariance);
  void start_at(const PoseFix& fix, const Eigen::Matrix3d& R);
  void look_back();
  PoseEstimate estimate_of(const State& state) const;
  void correct(const PoseFix& fix, const Eigen::Matrix3d& R);
  Eigen::Matrix3d fix_covariance(const PoseFix& fix) const;
  std::array<double, 3> velocity_covariance(const Odometry& odometry) const;

  PoseConfig config_;
  std::optional<State> state_;
  std::optional<Odometry> last_odometry_;
  std::optional<PoseFix> first_yawless_fix_;
  std::deque<Odometry> unplaced_;  ///< came while the pose was unknown, without a silence
  std::vector<PoseEstimate> past_;
  std::int64_t num_gaps_ = 0;
};

}  // namespace orchard::pose
