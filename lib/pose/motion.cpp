// SPDX-License-Identifier: BSD-3-Clause
#include "pose/motion.hpp"

#include <mrpt/poses/CPosePDFGaussian.h>

#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"
#include "timing/units.hpp"

namespace orchard::pose {

using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;
using mrpt::poses::CPosePDFGaussian;
namespace {

CPosePDFGaussian gaussian(const Eigen::Vector3d& T, const Eigen::Matrix3d& P) {
  return {mrpt::poses::CPose2D(T.x(), T.y(), T.z()), mrpt::math::CMatrixDouble33(P)};
}

// physical: how such robots change their velocity within a second that was not measured.
constexpr double kGapSpeedSd_mps = 0.5;
constexpr double kGapYawRateSd_radps = 0.3;

}  // namespace

Eigen::Vector3d arc_motion(double speed_mps, double yaw_rate_radps, double dt_s) {
  const double turn_rad = yaw_rate_radps * dt_s;
  const double length_m = speed_mps * dt_s;
  // sin(t)/t and (1-cos(t))/t; by their series for small t, where the quotients lose precision.
  const bool small = std::abs(turn_rad) < 1e-4;
  const double sinc = small ? 1.0 - turn_rad * turn_rad / 6.0 : std::sin(turn_rad) / turn_rad;
  const double cosc = small ? turn_rad / 2.0 : (1.0 - std::cos(turn_rad)) / turn_rad;
  return {length_m * sinc, length_m * cosc, turn_rad};
}

Eigen::Matrix<double, 3, 2> arc_jacobian(double speed_mps, double yaw_rate_radps, double dt_s) {
  const double half_turn_rad = 0.5 * yaw_rate_radps * dt_s;
  const double c = std::cos(half_turn_rad);
  const double s = std::sin(half_turn_rad);
  Eigen::Matrix<double, 3, 2> J;
  J << dt_s * c, -0.5 * speed_mps * dt_s * dt_s * s, dt_s * s, 0.5 * speed_mps * dt_s * dt_s * c,
      0.0, dt_s;
  return J;
}

PoseEstimate pose_estimate(std::int64_t utime, const Eigen::Vector3d& T_map_base,
                           const Eigen::Matrix3d& covariance) {
  PoseEstimate pose;
  pose.utime = utime;
  pose.x_m = T_map_base.x();
  pose.y_m = T_map_base.y();
  pose.yaw_rad = T_map_base.z();
  const Eigen::Matrix3d& P = covariance;
  pose.covariance = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
  return pose;
}

Eigen::Matrix3d compose_covariance(const Eigen::Vector3d& T_a_b, const Eigen::Matrix3d& P_ab,
                                   const Eigen::Vector3d& T_b_c, const Eigen::Matrix3d& P_bc) {
  CPosePDFGaussian T_a_c = gaussian(T_a_b, P_ab);
  T_a_c += gaussian(T_b_c, P_bc);
  const Eigen::Matrix3d P = T_a_c.cov.asEigen();
  return 0.5 * (P + P.transpose());
}

Eigen::Vector3d RelativeMotion::delta_with(const OdometryCalibration& other) const {
  return delta + calibration_jacobian * (other - calibration);
}

void RelativeMotion::drive(double speed_mps, double yaw_rate_radps,
                           const std::array<double, 3>& velocity_covariance, double dt_s) {
  const double v_mps = (1.0 + calibration[0]) * speed_mps;
  const double w_radps = (1.0 + calibration[1]) * yaw_rate_radps - calibration[2];
  const Eigen::Matrix<double, 3, 2> J_velocity = arc_jacobian(v_mps, w_radps, dt_s);
  Eigen::Matrix<double, 2, 3> velocity_calibration;
  velocity_calibration << speed_mps, 0.0, 0.0, 0.0, yaw_rate_radps, -1.0;
  Eigen::Matrix2d Q;
  Q << velocity_covariance[0], velocity_covariance[1], velocity_covariance[1],
      velocity_covariance[2];
  append(arc_motion(v_mps, w_radps, dt_s), J_velocity * Q * J_velocity.transpose(),
         J_velocity * velocity_calibration);
}

void RelativeMotion::append(const Eigen::Vector3d& T_now_next,
                            const Eigen::Matrix3d& step_covariance,
                            const Eigen::Matrix3d& step_jacobian) {
  covariance = compose_covariance(delta, covariance, T_now_next, step_covariance);
  calibration_jacobian = compose_jacobian_first(delta, T_now_next) * calibration_jacobian +
                         compose_jacobian_second(delta) * step_jacobian;
  delta = compose(delta, T_now_next);
  travel_m += T_now_next.head<2>().norm();
}

void DeadReckoning::set_default_noise(double speed_sd_fraction, double yaw_rate_sd_radps) {
  speed_sd_fraction_ = speed_sd_fraction;
  yaw_rate_sd_radps_ = yaw_rate_sd_radps;
}

double DeadReckoning::time_since_motion_s() const {
  if (!utime_) return 0.0;
  return timing::seconds(*utime_ - measured_utime_.value_or(*started_utime_));
}

void DeadReckoning::drive_to(std::int64_t utime, double speed_mps, double yaw_rate_radps) {
  const double dt_s = timing::seconds(utime - *utime_);
  if (dt_s <= 0.0) return;
  std::array<double, 3> covariance = velocity_covariance_;
  utime_ = utime;
  if (time_since_motion_s() > config_.gap_s) {
    // White velocity noise: the added position variance per second must not depend on the step.
    const double speed_sd_mps = std::max(kGapSpeedSd_mps, 0.3 * std::abs(speed_mps));
    covariance[0] += speed_sd_mps * speed_sd_mps / dt_s;
    covariance[2] += kGapYawRateSd_radps * kGapYawRateSd_radps / dt_s;
  }
  if (is_by_wheels_) {
    motion_.drive(speed_mps, yaw_rate_radps, covariance, dt_s);
    return;
  }
  RelativeMotion step;
  step.drive(speed_mps, yaw_rate_radps, covariance, dt_s);
  motion_.append(step.delta, step.covariance);
}

void DeadReckoning::add(const Odometry& odometry) {
  if (!std::isfinite(odometry.speed_mps) || !std::isfinite(odometry.yaw_rate_radps)) return;
  if (utime_ && odometry.utime < *utime_) return;
  velocity_covariance_ = odometry.covariance;
  if (velocity_covariance_[0] <= 0.0 && velocity_covariance_[2] <= 0.0) {
    const double speed_sd_mps = speed_sd_fraction_ * odometry.speed_mps;
    velocity_covariance_ = {speed_sd_mps * speed_sd_mps, 0.0,
                            yaw_rate_sd_radps_ * yaw_rate_sd_radps_};
  }
  if (!utime_) utime_ = started_utime_ = odometry.utime;
  if (measured_utime_) {
    // Encoders measure the mean velocity since the previous reading. If a driver reports the
    // instantaneous velocity instead, the mean lies between the two readings: add the variance of a
    // uniform distribution.
    const double speed_change_mps = odometry.speed_mps - speed_mps_;
    const double yaw_rate_change_radps = odometry.yaw_rate_radps - yaw_rate_radps_;
    velocity_covariance_[0] += speed_change_mps * speed_change_mps / 12.0;
    velocity_covariance_[1] += speed_change_mps * yaw_rate_change_radps / 12.0;
    velocity_covariance_[2] += yaw_rate_change_radps * yaw_rate_change_radps / 12.0;
  }
  // The reading that follows the last one tells the whole time between, however long; after a lost
  // one, most of that time was not measured.
  if (measured_utime_ && odometry.seq == seq_ + 1) measured_utime_ = odometry.utime;
  drive_to(odometry.utime, odometry.speed_mps, odometry.yaw_rate_radps);
  measured_utime_ = odometry.utime;
  ahead_.setZero();
  seq_ = odometry.seq;
  speed_mps_ = odometry.speed_mps;
  yaw_rate_radps_ = odometry.yaw_rate_radps;
  is_by_wheels_ = true;
}

void DeadReckoning::add(std::int64_t utime, const Eigen::Vector3d& T_measured_then,
                        const Eigen::Matrix3d& covariance, bool is_guess,
                        const Eigen::Matrix3d& calibration_jacobian) {
  if (!T_measured_then.allFinite() || !covariance.allFinite()) return;
  if (utime_ && utime <= *utime_) return;
  if (utime_) {
    const double dt_s = timing::seconds(utime - measured_utime_.value_or(*utime_));
    speed_mps_ = T_measured_then.x() / dt_s;
    yaw_rate_radps_ = T_measured_then.z() / dt_s;
  }
  is_by_wheels_ = false;
  // What was extrapolated since the last measurement is part of the measured motion.
  const Eigen::Vector3d T_then = T_measured_then + calibration_jacobian * motion_.calibration;
  Eigen::Matrix3d step_jacobian = calibration_jacobian;
  step_jacobian.topRows<2>() = geometry::rotation(-ahead_.z()) * calibration_jacobian.topRows<2>();
  motion_.append(geometry::between(ahead_, T_then), covariance, step_jacobian);
  motion_.has_guess |= is_guess;
  ahead_.setZero();
  utime_ = utime;
  if (!started_utime_) started_utime_ = utime;
  measured_utime_ = utime;
}

void DeadReckoning::advance_to(std::int64_t utime) {
  if (!utime_) utime_ = started_utime_ = utime;
  if (utime <= *utime_) return;
  const Eigen::Vector3d before = motion_.delta;
  drive_to(utime, speed_mps_, yaw_rate_radps_);
  ahead_ = compose(ahead_, geometry::between(before, motion_.delta));
}

void DeadReckoning::restart(const OdometryCalibration& calibration) {
  motion_ = RelativeMotion{};
  motion_.calibration = calibration;
}

Eigen::Vector2d DeadReckoning::velocity_with(const OdometryCalibration& calibration) const {
  if (!is_by_wheels_) return {speed_mps_, yaw_rate_radps_};
  return {(1.0 + calibration[0]) * speed_mps_,
          (1.0 + calibration[1]) * yaw_rate_radps_ - calibration[2]};
}

void DeadReckoning::set_velocity(double speed_mps, double yaw_rate_radps) {
  speed_mps_ = speed_mps;
  yaw_rate_radps_ = yaw_rate_radps;
}

}  // namespace orchard::pose
