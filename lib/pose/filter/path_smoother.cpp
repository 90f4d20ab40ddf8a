// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/path_smoother.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "pose/filter/fix_hypotheses.hpp"
#include "pose/graph/calibration.hpp"
#include "pose/graph/solver.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

Eigen::Vector3d off(const PoseEstimate& pose, const PoseEstimate& from) {
  return {pose.x_m - from.x_m, pose.y_m - from.y_m,
          geometry::wrap_angle_rad(pose.yaw_rad - from.yaw_rad)};
}

// derived: between keyframes the path follows the wheels, which err by millimetres over so little;
// the path is solved when it has grown by a tenth, so that the cost per metre stays constant.
constexpr double kKeyframeTravel_m = 1.5;
constexpr double kKeyframeTurn_rad = 0.5;
constexpr double kGrowth = 0.1;
constexpr int kKeyframesMin = 20;
// derived: a solution that leaves out more than one position of five is none; and as much travel
// behind a gap as makes one determines position and heading again.
constexpr double kLeftOutMax = 0.2;
constexpr double kGap_m = 20.0;
// derived: no division by zero at rest, and where the wheels' errors never change.
constexpr double kSpeedMin_mps = 0.1;
constexpr double kSdMin = 1e-6;
constexpr double kKeptMin = 1e-9;

SlamConfig graph_config(const PoseConfig& config) {
  SlamConfig graph = config.slam;
  graph.speed_scale_sd = config.fusion.speed_scale_sd;
  if (config.fusion.use_imu) {
    graph.yaw_rate_bias_sd_radps = std::max(graph.yaw_rate_bias_sd_radps, kGyroBiasSd_radps);
  }
  return graph;
}

}  // namespace

std::vector<PoseEstimate> mean_path(const std::vector<CrediblePath>& paths) {
  double sum = 0.0;
  for (const CrediblePath& path : paths) sum += path.probability;
  std::vector<PoseEstimate> mixed = paths.front().poses;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    PoseEstimate& pose = mixed[i];
    const PoseEstimate first = pose;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const CrediblePath& path : paths) {
      mean += path.probability / sum * off(path.poses[i], first);
    }
    pose.x_m += mean.x();
    pose.y_m += mean.y();
    pose.yaw_rad = geometry::wrap_angle_rad(pose.yaw_rad + mean.z());
    pose.covariance = {};
    for (const CrediblePath& path : paths) {
      const Eigen::Vector3d d = off(path.poses[i], first) - mean;
      const auto& own = path.poses[i].covariance;
      const double spread[] = {d.x() * d.x(), d.x() * d.y(), d.x() * d.z(),
                               d.y() * d.y(), d.y() * d.z(), d.z() * d.z()};
      for (std::size_t k = 0; k < own.size(); ++k) {
        pose.covariance[k] += path.probability / sum * (own[k] + spread[k]);
      }
    }
  }
  return mixed;
}

double notable_spread_m(const std::vector<CrediblePath>& paths) {
  std::vector<CrediblePath> exact = paths;
  for (CrediblePath& path : exact) {
    for (PoseEstimate& pose : path.poses) pose.covariance = {};
  }
  double largest2 = 0.0;
  const std::vector<PoseEstimate> spread = mean_path(exact);
  for (std::size_t i = 0; i < spread.size(); ++i) {
    const auto position_variance = [](const PoseEstimate& pose) {
      return pose.covariance[0] + pose.covariance[3];
    };
    const double own2 = position_variance(paths.front().poses[i]);
    const double among2 = position_variance(spread[i]);
    if (among2 > own2) largest2 = std::max(largest2, among2);
  }
  return std::sqrt(largest2);
}

PathSmoother::PathSmoother(const PoseConfig& config)
    : config_(graph_config(config)), motion_(config_) {
  motion_.set_default_noise(config.speed_sd_fraction, config.yaw_rate_sd_radps);
  graph_.calibrations.push_back(OdometryCalibration::Zero());
  graph_.calibration_walk_sd = initial_walk_sd(config_);
}

void PathSmoother::add_keyframe(const Eigen::Vector3d& T_map_base) {
  Keyframe keyframe;
  keyframe.utime = motion_.utime();
  keyframe.T_map_base = T_map_base;
  if (!graph_.keyframes.empty()) {
    const Keyframe& before = graph_.keyframes.back();
    keyframe.motion = motion_.motion();
    keyframe.travel_m = before.travel_m + keyframe.motion.travel_m;
    const auto interval = [](double travel_m) {
      return static_cast<int>(travel_m / kCalibrationTravel_m);
    };
    if (interval(keyframe.travel_m) > interval(before.travel_m)) {
      graph_.calibrations.push_back(OdometryCalibration(graph_.calibrations.back()));
    }
    keyframe.calibration = static_cast<int>(graph_.calibrations.size()) - 1;
  }
  graph_.keyframes.push_back(std::move(keyframe));
  motion_.restart(graph_.calibrations.back());
}

void PathSmoother::follow(const Eigen::Vector3d& T_map_base) {
  const RelativeMotion& moved = motion_.motion();
  if (graph_.keyframes.empty() || moved.travel_m >= kKeyframeTravel_m ||
      std::abs(moved.delta.z()) >= kKeyframeTurn_rad) {
    add_keyframe(T_map_base);
  }
}

void PathSmoother::add(const Odometry& odometry, const Eigen::Vector3d& T_map_base) {
  motion_.add(odometry);
  follow(T_map_base);
}

void PathSmoother::add(std::int64_t utime, AbsolutePosition position,
                       const Eigen::Vector3d& T_map_base) {
  if (!motion_.started()) return;
  motion_.advance_to(utime);
  follow(T_map_base);
  const double travel_m = graph_.keyframes.back().travel_m + motion_.motion().travel_m;
  if (travel_m - position_travel_m_ > kGap_m) {
    if (!due_travel_m_) before_gap_ = position_keyframe_;
    due_travel_m_ = travel_m + kGap_m;
  }
  position_travel_m_ = travel_m;
  position_keyframe_ = graph_.keyframes.size() - 1;
  position.utime = utime;
  position.T_keyframe_then = motion_.motion().delta_with(graph_.calibrations.back());
  add_position(position, graph_);
}

void PathSmoother::tell(std::int64_t utime, const Eigen::Vector3d& T_map_base) {
  if (graph_.keyframes.empty()) return;
  const Eigen::Vector3d since = arc_motion(motion_.speed_mps(), motion_.yaw_rate_radps(),
                                           timing::seconds(utime - motion_.utime()));
  told_.tell({utime, static_cast<int>(graph_.keyframes.size()) - 1,
              geometry::compose(motion_.motion().delta_with(graph_.calibrations.back()), since)},
             T_map_base, graph_);
}

void PathSmoother::place(const Eigen::Vector3d& T_map_local) {
  apply_georeference(T_map_local, graph_);
}

std::optional<SmoothedPose> PathSmoother::observe(const std::vector<DisplacedTime>& displaced) {
  if (!graph_.georeferenced || graph_.keyframes.empty()) return std::nullopt;
  // In a gap there is nothing to solve: its length is not known before positions have followed it.
  const double travel_m = graph_.keyframes.back().travel_m;
  if (travel_m - position_travel_m_ > kKeyframeTravel_m) return std::nullopt;
  const bool has_grown =
      static_cast<double>(graph_.keyframes.size()) >= num_solved_ * (1.0 + kGrowth) + kKeyframesMin;
  const bool is_due = due_travel_m_ ? travel_m >= *due_travel_m_ : has_grown;
  if (!is_due || !solve(displaced)) return std::nullopt;
  if (left_out().newest_contradicts) return std::nullopt;
  const Keyframe& newest = graph_.keyframes.back();
  const Eigen::Vector3d delta = motion_.motion().delta_with(graph_.calibrations.back());
  SmoothedPose pose;
  pose.T_map_base = geometry::compose(newest.T_map_base, delta);
  pose.covariance =
      after_motion(joint_covariance(newest), newest.T_map_base, motion_.motion(), delta)
          .topLeftCorner<3, 3>();
  if (!graph_.receiver_errors.empty()) pose.receiver_error_m = graph_.receiver_errors.back().p_m;
  return pose;
}

void PathSmoother::finish(const std::vector<DisplacementHistory>& histories) {
  if (!graph_.georeferenced || graph_.keyframes.empty()) return;
  const Keyframe& last = graph_.keyframes.back();
  if (motion_.utime() > last.utime) {
    add_keyframe(geometry::compose(last.T_map_base,
                                   motion_.motion().delta_with(graph_.calibrations.back())));
  }
  told_.end(graph_);
  std::optional<SlamGraph> likeliest;
  std::vector<CrediblePath> paths;
  const auto try_history = [&](const DisplacementHistory& history, bool is_last_resort) {
    if (solve(history.displaced, is_last_resort)) {
      paths.push_back({history.probability, told_.key_poses(graph_)});
      if (!likeliest) likeliest = graph_;
    }
    if (likeliest) graph_ = *likeliest;
  };
  for (const DisplacementHistory& history : histories) try_history(history, false);
  // Without any, the path would be the poses told, with all their jumps.
  is_doubtful_ = paths.empty();
  if (is_doubtful_) try_history(histories.front(), true);
  if (paths.empty()) return;
  mean_ = mean_path(paths);
  open_sd_m_ = notable_spread_m(paths);
}

/// Spreads the difference between dead reckoning over a gap and the pose behind it along the way:
/// from a jump, the solver converges to paths that no wheels could have driven.
void PathSmoother::close_gap() {
  if (!due_travel_m_) return;
  due_travel_m_.reset();
  std::vector<Keyframe>& keyframes = graph_.keyframes;
  const Eigen::Vector3d first = keyframes[before_gap_].T_map_base;
  const Eigen::Vector3d last = keyframes.back().T_map_base;
  const double first_m = keyframes[before_gap_].travel_m;
  const double way_m = keyframes.back().travel_m - first_m;
  if (way_m <= 0.0) return;
  const auto part = [&](std::size_t k) { return (keyframes[k].travel_m - first_m) / way_m; };
  const auto reckon = [&](double turned_rad) {
    Eigen::Vector3d pose = first;
    for (std::size_t k = before_gap_ + 1; k < keyframes.size(); ++k) {
      Eigen::Vector3d delta =
          keyframes[k].motion.delta_with(graph_.calibrations[keyframes[k].calibration]);
      delta.z() += turned_rad * (part(k) - part(k - 1));
      pose = geometry::compose(pose, delta);
      keyframes[k].T_map_base = pose;
    }
  };
  reckon(0.0);
  reckon(geometry::wrap_angle_rad(last.z() - keyframes.back().T_map_base.z()));
  const Eigen::Vector2d off_m = last.head<2>() - keyframes.back().T_map_base.head<2>();
  for (std::size_t k = before_gap_ + 1; k < keyframes.size(); ++k) {
    keyframes[k].T_map_base.head<2>() += part(k) * off_m;
  }
}

/// Returns true if the wheels' errors of the solution change as the model allows.
bool PathSmoother::is_plausible() const {
  const Eigen::Array3d most = CalibrationPrior::initial_sd(config_).array().max(kSdMin);
  return (graph_.calibration_walk_sd.array() <= most).all();
}

bool PathSmoother::solve(const std::vector<DisplacedTime>& displaced, bool is_last_resort) {
  mark_displaced(displaced, graph_);
  num_solved_ = static_cast<int>(graph_.keyframes.size());
  close_gap();
  SlamGraph before = graph_;
  // First without the robust loss, which would treat the positions after a gap as outliers and keep
  // the filter's drift.
  GraphSolution solution = solve_graph(graph_, true, config_);
  if (!solution.solved) return false;
  RejectedFixes out = left_out();
  if (out.num_contradicting > kLeftOutMax * out.num_fixes) {  // gross outliers distorted that start
    graph_ = before;
    solution = solve_graph(graph_, false, config_);
    if (!solution.solved) return false;
    out = left_out();
  }
  const bool is_good = out.num_contradicting <= kLeftOutMax * out.num_fixes && is_plausible();
  if (!is_good && !is_last_resort) {
    graph_ = std::move(before);  // too many positions contradict the solution, or the wheels do
    return false;
  }
  corrected_ = true;
  return solution.calibration_covariance.has_value();  // else the covariances are not valid
}

std::optional<WheelErrorNoise> PathSmoother::wheel_error_noise() const {
  if (revision_ == 0 && !corrected_) return std::nullopt;
  std::vector<double> speeds_mps;
  for (std::size_t k = 1; k < graph_.keyframes.size(); ++k) {
    const Keyframe& now = graph_.keyframes[k];
    const double dt_s = timing::seconds(now.utime - graph_.keyframes[k - 1].utime);
    if (dt_s > 0.0) speeds_mps.push_back(now.motion.travel_m / dt_s);
  }
  if (speeds_mps.empty()) return std::nullopt;
  const double speed_mps = std::max(geometry::median(speeds_mps), kSpeedMin_mps);
  // The same process as in the graph: another one with as large a step per interval errs by another
  // length in a gap.
  const Eigen::Vector3d& walk = graph_.calibration_walk_sd;
  const Eigen::Vector3d sd = CalibrationPrior::initial_sd(config_);
  const Eigen::Array3d kept = calibration_decay(walk, config_).array().max(kKeptMin);
  const Eigen::Array3d travel_m = kCalibrationTravel_m / (-kept.log()).max(kKeptMin);
  WheelErrorNoise changes;
  changes.slip_sd = sd[0];
  changes.turn_slip_sd = sd[1];
  changes.slip_travel_m = travel_m[0];
  changes.turn_slip_travel_m = travel_m[1];
  changes.curvature_walk = walk[2] / speed_mps / std::sqrt(kCalibrationTravel_m);
  return changes;
}

std::optional<Trajectory> PathSmoother::take_correction() {
  if (!corrected_) return std::nullopt;
  corrected_ = false;
  Trajectory trajectory;
  trajectory.utime = motion_.utime();
  trajectory.revision = ++revision_;
  trajectory.poses = mean_.empty() ? told_.key_poses(graph_) : mean_;
  told_.correct(graph_);
  return trajectory;
}

}  // namespace orchard::pose
