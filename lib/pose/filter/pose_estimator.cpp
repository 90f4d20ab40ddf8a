// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/pose_estimator.hpp"

#include <mrpt/poses/CPosePDFGaussian.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <variant>

#include "geometry/angles.hpp"
#include "pose/arc_motion.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

using mrpt::poses::CPose2D;
using mrpt::poses::CPosePDFGaussian;

/// Matrix for fixes of two or three dimensions. The bound on the size avoids heap allocation and
/// shortens compilation.
using UpTo3 = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using VectorUpTo3 = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;

Eigen::Matrix3d symmetric(const std::array<double, 6>& c) {
  Eigen::Matrix3d m;
  m << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return m;
}

CPosePDFGaussian gaussian(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance) {
  return {CPose2D(mean.x(), mean.y(), mean.z()), mrpt::math::CMatrixDouble33(covariance)};
}

}  // namespace

PoseEstimator::PoseEstimator(const PoseConfig& config) : config_(config) {}

void PoseEstimator::add(const Measurement& measurement) {
  if (const auto* odometry = std::get_if<Odometry>(&measurement)) add(*odometry);
  if (const auto* fix = std::get_if<PoseFix>(&measurement)) add(*fix);
}

void PoseEstimator::add(const Odometry& odometry) {
  if (config_.mode == PoseMode::kOdometry && !state_) {
    state_ = State{odometry.utime, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  }
  if (state_) {
    const bool silent = last_odometry_ && timing::seconds(odometry.utime - last_odometry_->utime) >
                                              config_.odometry_gap_max_s;
    if (silent) {
      ++num_gaps_;
      if (config_.mode == PoseMode::kOdometry) {
        state_->utime = odometry.utime;
      } else {
        state_.reset();
      }
    } else {
      predict_to(odometry.utime, odometry.speed_mps, odometry.yaw_rate_radps,
                 velocity_covariance(odometry));
    }
  }
  last_odometry_ = odometry;
  if (!state_) {
    const bool silent =
        !unplaced_.empty() &&
        timing::seconds(odometry.utime - unplaced_.back().utime) > config_.odometry_gap_max_s;
    if (silent) unplaced_.clear();
    unplaced_.push_back(odometry);
    while (odometry.utime - unplaced_.front().utime > kPastMax_us) unplaced_.pop_front();
  }
}

/// Computes the poses before the first known one by integrating the odometry backwards: each arc is
/// reversed by negating both velocities.
void PoseEstimator::backfill_past_poses() {
  State state = *state_;
  Odometry after = unplaced_.back();
  bool is_near = timing::seconds(state.utime - after.utime) <= config_.odometry_gap_max_s;
  for (auto odometry = unplaced_.rbegin(); is_near && odometry != unplaced_.rend(); ++odometry) {
    const double dt_s = timing::seconds(state.utime - odometry->utime);
    move(state, -after.speed_mps, -after.yaw_rate_radps, dt_s, velocity_covariance(after));
    state.utime = odometry->utime;
    after = *odometry;
    if (state.utime < state_->utime) past_.push_back(estimate_of(state));
  }
  std::reverse(past_.begin(), past_.end());
  unplaced_.clear();
}

void PoseEstimator::add(const PoseFix& fix) {
  const Eigen::Matrix3d R = fix_covariance(fix);
  const bool dead_reckoned =
      config_.mode == PoseMode::kFixesAndOdometry && state_ && last_odometry_ &&
      timing::seconds(fix.utime - last_odometry_->utime) <= config_.odometry_gap_max_s;
  if (!dead_reckoned) {
    const bool was_known = state_.has_value();
    start_at(fix, R);
    if (!was_known && state_ && !unplaced_.empty()) backfill_past_poses();
    return;
  }
  predict_to(fix.utime, last_odometry_->speed_mps, last_odometry_->yaw_rate_radps,
             velocity_covariance(*last_odometry_));
  correct(fix, R);
}

std::optional<PoseEstimate> PoseEstimator::estimate() const {
  if (!state_) return std::nullopt;
  return estimate_of(*state_);
}

PoseEstimate PoseEstimator::estimate_of(const State& state) const {
  PoseEstimate pose;
  pose.utime = state.utime;
  pose.x_m = state.mean.x();
  pose.y_m = state.mean.y();
  pose.yaw_rad = geometry::wrap_angle_rad(state.mean.z());
  const Eigen::Matrix3d& P = state.covariance;
  pose.covariance = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
  return pose;
}

void PoseEstimator::predict_to(std::int64_t utime, double speed_mps, double yaw_rate_radps,
                               const std::array<double, 3>& velocity_covariance) {
  move(*state_, speed_mps, yaw_rate_radps, timing::seconds(utime - state_->utime),
       velocity_covariance);
  state_->utime = utime;
}

void PoseEstimator::move(State& state, double speed_mps, double yaw_rate_radps, double dt_s,
                         const std::array<double, 3>& velocity_covariance) {
  Eigen::Matrix2d Q;
  Q << velocity_covariance[0], velocity_covariance[1], velocity_covariance[1],
      velocity_covariance[2];
  const Eigen::Matrix<double, 3, 2> J = arc_jacobian(speed_mps, yaw_rate_radps, dt_s);
  CPosePDFGaussian T_map_base = gaussian(state.mean, state.covariance);
  T_map_base += gaussian(arc_motion(speed_mps, yaw_rate_radps, dt_s), J * Q * J.transpose());
  state.mean = {T_map_base.mean.x(), T_map_base.mean.y(), T_map_base.mean.phi()};
  const Eigen::Matrix3d P = T_map_base.cov.asEigen();
  state.covariance = 0.5 * (P + P.transpose());
}

void PoseEstimator::start_at(const PoseFix& fix, const Eigen::Matrix3d& R) {
  State state{fix.utime, {fix.x_m, fix.y_m, fix.yaw_rad}, R};
  if (!fix.has_yaw) {
    if (!first_yawless_fix_) {
      first_yawless_fix_ = fix;
      return;
    }
    const double dx_m = fix.x_m - first_yawless_fix_->x_m;
    const double dy_m = fix.y_m - first_yawless_fix_->y_m;
    const double travel_m = std::hypot(dx_m, dy_m);
    if (travel_m < config_.heading_baseline_m) {
      // Without odometry, keep the known heading until the next baseline is travelled.
      if (!state_) return;
      state.mean.z() = state_->mean.z();
      state.covariance(2, 2) = state_->covariance(2, 2);
    } else {
      const bool reverse = last_odometry_ && last_odometry_->speed_mps < 0.0;
      state.mean.z() = std::atan2(reverse ? -dy_m : dy_m, reverse ? -dx_m : dx_m);
      state.covariance(2, 2) = (R(0, 0) + R(1, 1)) / (travel_m * travel_m);
      first_yawless_fix_ = fix;
    }
    state.covariance(0, 2) = state.covariance(2, 0) = 0.0;
    state.covariance(1, 2) = state.covariance(2, 1) = 0.0;
  }
  state_ = state;
}

void PoseEstimator::correct(const PoseFix& fix, const Eigen::Matrix3d& R) {
  const int dimension = fix.has_yaw ? 3 : 2;
  const UpTo3 H = UpTo3::Identity(dimension, 3);
  VectorUpTo3 innovation(dimension);
  innovation(0) = fix.x_m - state_->mean.x();
  innovation(1) = fix.y_m - state_->mean.y();
  if (fix.has_yaw) innovation(2) = geometry::wrap_angle_rad(fix.yaw_rad - state_->mean.z());
  const UpTo3 R_used = R.topLeftCorner(dimension, dimension);
  const Eigen::Matrix3d P = state_->covariance;
  const UpTo3 S = H * P * H.transpose() + R_used;
  const UpTo3 K = P * H.transpose() * S.inverse();
  state_->mean += K * innovation;
  state_->mean.z() = geometry::wrap_angle_rad(state_->mean.z());
  // Joseph's form keeps the covariance positive definite despite rounding of the gain.
  const Eigen::Matrix3d A = Eigen::Matrix3d::Identity() - K * H;
  state_->covariance = A * P * A.transpose() + K * R_used * K.transpose();
}

Eigen::Matrix3d PoseEstimator::fix_covariance(const PoseFix& fix) const {
  Eigen::Matrix3d R = symmetric(fix.covariance);
  const double position_variance = config_.fix_position_sd_m * config_.fix_position_sd_m;
  if (R(0, 0) <= 0.0 || R(1, 1) <= 0.0) {
    R.setZero();
    R(0, 0) = R(1, 1) = position_variance;
  }
  if (R(2, 2) <= 0.0) {
    R.row(2).setZero();
    R.col(2).setZero();
    R(2, 2) = config_.fix_yaw_sd_rad * config_.fix_yaw_sd_rad;
  }
  return R;
}

std::array<double, 3> PoseEstimator::velocity_covariance(const Odometry& odometry) const {
  if (odometry.covariance[0] > 0.0 || odometry.covariance[2] > 0.0) return odometry.covariance;
  const double speed_sd_mps = config_.speed_sd_fraction * odometry.speed_mps;
  return {speed_sd_mps * speed_sd_mps, 0.0, config_.yaw_rate_sd_radps * config_.yaw_rate_sd_radps};
}

}  // namespace orchard::pose
