// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pose/filter/fix_hypotheses.hpp"
#include "pose/filter/gnss_positions.hpp"
#include "pose/filter/path_smoother.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Returns the covariance of a fix (x, y, yaw) [m, m, rad]: as stated, or as configured for what it
/// does not state.
Eigen::Matrix3d fix_covariance(const PoseFix& fix, const PoseConfig& config);

/// Localiser of mode `fixes`: each fix is a pose by itself, as in the paper, where the robot is
/// placed by hand (Shalal et al. 2013, section 6.1). Fixes without yaw point along the way driven,
/// anew every heading_baseline_m; before the first there is no pose.
class Fixes : public Localiser {
 public:
  explicit Fixes(const PoseConfig& config) : config_(config) {}

  void add(const Measurement& measurement) override;
  std::optional<PoseEstimate> estimate() const override { return estimate_; }

 private:
  PoseConfig config_;
  std::optional<PoseFix> baseline_start_;  ///< fix without yaw
  std::optional<PoseEstimate> estimate_;
};

/// Localiser of modes `fused`, `fixes_and_odometry` and `odometry`: estimates T_map_base from
/// wheels, IMU, GNSS and fixes, as configured.
///
/// Map is the east-north plane of the GNSS datum; POSE_FIX must be in this frame, too. Without GNSS
/// and fixes the robot starts at the map's origin. With them there is no pose until the first fix
/// with a heading, or until the positions over at least heading_baseline_m give one; the way there
/// is told afterwards. Without wheels each fix with a heading is a pose by itself. Mode `fused`
/// also smooths the path. Displaced positions (jumps, reflected signals) are found by
/// FixHypotheses, left out and reported by warning(), as are those of a frozen receiver. The
/// scatter of a receiver's steps is its noise. If it clearly exceeds the claimed covariance, it is
/// used instead; if it is less, the difference is a time-correlated error, so that a burst of fixes
/// counts little more than one fix.
class Fusion : public Localiser {
 public:
  explicit Fusion(const PoseConfig& config);

  void add(const Measurement& measurement) override;
  std::optional<PoseEstimate> estimate() const override;

  /// Returns the path up to the first known pose, at most the last kPastMax_us and one
  /// step, without a gap.
  std::vector<PoseEstimate> take_past_poses() override { return std::exchange(past_, {}); }

  static constexpr std::int64_t kPastMax_us = 60'000'000;  // derived: bounds the memory

  std::optional<Trajectory> take_correction() override;
  void finish() override;
  std::string warning() const override;
  std::vector<Finding> findings() const override;

  /// Returns the estimated sensor errors: speed scale with the slip, turn per metre [1/m], gyro
  /// bias [rad/s].
  Eigen::Vector3d sensor_errors() const { return filter().sensor_errors(); }

  /// Returns true if the latest position is held to be displaced, e.g. by reflected signals.
  bool is_displaced() const { return hypotheses_.best().is_displaced; }

 private:
  const FusionFilter& filter() const { return hypotheses_.best().filter; }
  void add(const Odometry& odometry);
  void add(const Imu& imu);
  void add(const Gnss& gnss);
  void add(const PoseFix& fix);
  void set_receiver_noise(PositionObservation& observation);
  void use_position(const PositionObservation& observation);
  void start(const PositionObservation& observation);
  void move(const MotionStep& step);
  void go_back();
  Eigen::Vector3d path_pose() const;
  void place(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance, bool is_gnss);
  void smooth(const PositionObservation& observation, std::optional<double> yaw_rad = std::nullopt,
              double yaw_sd_rad = 1.0);
  Odometry last_measured_motion() const;
  void move_to(std::int64_t utime, double speed_mps, double yaw_rate_radps);
  void move_to(std::int64_t utime);
  bool has_gyro_at(std::int64_t utime) const;
  double time_since_motion_s(std::int64_t utime) const;
  void note(std::string text);

  PoseConfig config_;
  FixHypotheses hypotheses_;
  FusionFilter local_;  ///< dead reckoning from the robot's start, until the pose in map is known
  GnssPositions positions_;
  GnssMonitor monitor_;
  std::optional<PathSmoother> smoother_;  ///< of mode fused, if GNSS or fixes are used
  bool is_started_ = false;  ///< the filter's frame is map; else it starts at the robot's start
  bool is_placed_ = false;   ///< the pose in map is known
  std::optional<Eigen::Vector2d> first_local_m_;  ///< of the first position, dead-reckoned
  bool is_finished_ = false;
  std::optional<std::int64_t> utime_;  ///< time of the filter's state
  std::optional<Odometry> odometry_;
  std::optional<Imu> imu_;
  double travel_m_ = 0.0;  ///< since the last GNSS fix

  struct PastStep {
    std::int64_t utime;  ///< before the step
    MotionStep step;
  };
  std::deque<PastStep> unplaced_;  ///< without a gap, while the pose is unknown
  std::vector<PoseEstimate> past_;

  struct LastFix {
    std::int64_t utime;
    Eigen::Vector2d p_map_m;
    Eigen::Vector2d antenna_m;  ///< estimated by the filter after this fix
  };
  std::optional<LastFix> last_fix_;
  std::int64_t num_frozen_ = 0;
  std::int64_t num_odometry_gaps_ = 0;
  double odometry_gap_max_s_ = 0.0;
  std::string note_;  ///< last problem, for warning()
  std::int64_t note_utime_ = 0;
};

}  // namespace orchard::pose
