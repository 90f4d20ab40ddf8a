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

/// Localiser of modes `fixes`, `fixes_and_odometry` and `odometry`: an extended Kalman filter over
/// (x, y, yaw) of T_map_base, with MRPT's composition of Gaussian poses as prediction.
///
/// Measurements must come in order of time; the result is a pure function of their sequence.
/// Without odometry each fix is a pose by itself, as in the paper, where the robot is placed by
/// hand (Shalal et al. 2013, section 6.1). Fixes without yaw give no pose until the robot has
/// travelled heading_baseline_m.
class PoseEstimator : public Localiser {
 public:
  explicit PoseEstimator(const PoseConfig& config);

  void add(const Measurement& measurement) override;

  /// Dead-reckons to the odometry's time with its velocity, the mean since the previous reading. A
  /// gap longer than odometry_gap_max_s drops the pose until the next fix. Mode odometry has no
  /// fixes: it assumes that the robot stood still and counts the gap in num_gaps().
  void add(const Odometry& odometry);

  /// Dead-reckons to the fix's time with the last velocity, then corrects.
  void add(const PoseFix& fix);

  /// Returns the pose at the time of the last measurement; none while it is unknown.
  std::optional<PoseEstimate> estimate() const override;

  /// Returns the path up to the first known pose, from the earlier odometry: at most the last
  /// kPastMax_us, without a gap.
  std::vector<PoseEstimate> take_past_poses() override { return std::exchange(past_, {}); }

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
  void backfill_past_poses();
  PoseEstimate estimate_of(const State& state) const;
  void correct(const PoseFix& fix, const Eigen::Matrix3d& R);
  Eigen::Matrix3d fix_covariance(const PoseFix& fix) const;
  std::array<double, 3> velocity_covariance(const Odometry& odometry) const;

  PoseConfig config_;
  std::optional<State> state_;
  std::optional<Odometry> last_odometry_;
  std::optional<PoseFix> first_yawless_fix_;
  std::deque<Odometry> unplaced_;  ///< odometry without a gap while the pose is unknown
  std::vector<PoseEstimate> past_;
  std::int64_t num_gaps_ = 0;
};

}  // namespace orchard::pose
