// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/attitude_filter.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

using geometry::square;

// physical: standard gravity [m/s2].
constexpr double kGravity_mps2 = 9.80665;
// physical: data sheets of small units (MEMS) state roll and pitch within half a degree, a bias of
// the rates of up to 1 degree per second, and one of the force of 5 mg, which no motion shows.
constexpr double kStatedSd_rad = 0.5 * geometry::kPi / 180.0;
constexpr double kRateBiasSd_radps = 1.0 * geometry::kPi / 180.0;
constexpr double kForceBiasSd_mps2 = 0.005 * kGravity_mps2;
// physical: the in-run instability of such a rate bias: 10 degrees per hour over a minute.
constexpr double kRateBiasWalk_radps = 6.3e-6;
// physical: noise of a rate without a stated variance: 0.1 degrees per second.
constexpr double kRateSd_radps = 0.1 * geometry::kPi / 180.0;
// physical: motors and bumps shake a robot by up to a tenth of gravity or two.
constexpr double kStartForceSd_mps2 = 1.5;
// physical: what wheels do not tell of a drive's own acceleration, before its scatter is known.
constexpr double kForceSd_mps2 = 0.3;
// derived: a speed of up to 2 m/s either way, the fastest at which orchards are driven through,
// each as likely as the next: 2 / sqrt(3).
constexpr double kSpeedSd_mps = 1.15;
// physical: a cruising speed is held for about a row: 100 m at 1 m/s.
constexpr double kSpeedHeld_s = 100.0;
// derived: a mean is longer than shaking by bumps and motors, and shorter than gyros drift.
constexpr double kMean_s = 1.0;
// derived: the means that tell the noise.
constexpr int kMeansMax = 60;
// derived: steps longer than this are gaps, over which rates say nothing.
constexpr double kGap_s = 1.0;
constexpr std::int64_t kKept_us = 1'500'000;

/// Whether a unit tells its tilt, and better than its forces can.
bool states_tilt_better(const Imu& imu) {
  if (!imu.has_orientation) return false;
  const bool has_force = std::hypot(imu.acceleration_mps2[0], imu.acceleration_mps2[1],
                                    imu.acceleration_mps2[2]) > 0.5 * kGravity_mps2;
  const bool is_precise = imu.orientation_variance > 0.0 &&
                          imu.orientation_variance < square(kForceBiasSd_mps2 / kGravity_mps2);
  return !has_force || is_precise;
}

Attitude stated(const Imu& imu) {
  const bool is_known = imu.orientation_variance > 0.0;
  return {imu.roll_rad, imu.pitch_rad,
          is_known ? std::sqrt(imu.orientation_variance) : kStatedSd_rad};
}

}  // namespace

AttitudeFilter::AttitudeFilter() : force_variance_(square(kForceSd_mps2)) {}

void AttitudeFilter::add(const Odometry& odometry) {
  if (odometry_ && odometry.utime > odometry_->utime) {
    const double time_s = timing::seconds(odometry.utime - odometry_->utime);
    acceleration_mps2_ =
        time_s < kGap_s ? (odometry.speed_mps - odometry_->speed_mps) / time_s : 0.0;
  }
  odometry_ = odometry;
  set_speed(odometry.speed_mps, 0.0);
}

void AttitudeFilter::set_speed(double speed_mps, double variance_m2ps2) {
  state_(kSpeed) = speed_mps;
  covariance_.row(kSpeed).setZero();
  covariance_.col(kSpeed).setZero();
  covariance_(kSpeed, kSpeed) = variance_m2ps2;
}

bool AttitudeFilter::has_wheels(std::int64_t utime) const {
  return odometry_ && timing::seconds(utime - odometry_->utime) < kGap_s;
}

void AttitudeFilter::add(const Imu& imu) {
  if (!samples_.empty() && imu.utime <= samples_.back().utime) return;
  const Attitude attitude = states_tilt_better(imu) ? stated(imu) : estimated(imu);
  heading_rate_radps_ =
      pose::heading_rate_radps(attitude, imu.angular_rate_radps[1], imu.angular_rate_radps[2]);
  samples_.push_back({imu.utime, attitude});
  while (imu.utime - samples_.front().utime > kKept_us) samples_.pop_front();
}

/// The tilt by rates and forces.
Attitude AttitudeFilter::estimated(const Imu& imu) {
  const double time_s =
      samples_.empty() ? kGap_s : timing::seconds(imu.utime - samples_.back().utime);
  if (time_s >= kGap_s) {
    start(imu);
  } else {
    predict(imu, time_s);
    gather(imu, time_s);
    if (!is_upright({state_(0), state_(1), 0.0})) start(imu);  // what no robot measures led there
  }
  return {state_(0), state_(1), sd_rad()};
}

/// Begins with the direction of one force, which the robot's own motion and shaking turn.
void AttitudeFilter::start(const Imu& imu) {
  const auto& f = imu.acceleration_mps2;
  state_ << std::atan2(f[1], f[2]), std::atan2(-f[0], std::hypot(f[1], f[2])), 0.0, 0.0, 0.0, 0.0;
  covariance_.setZero();
  covariance_.diagonal().head<2>().setConstant(square(kStartForceSd_mps2 / kGravity_mps2));
  covariance_.diagonal().segment<3>(kBiases).setConstant(square(kRateBiasSd_radps));
  if (has_wheels(imu.utime)) {
    set_speed(odometry_->speed_mps, 0.0);
  } else {
    set_speed(0.0, square(kSpeedSd_mps));
  }
  force_variance_ = square(kForceSd_mps2);
  num_means_ = 0;
  gathered_s_ = 0.0;
  num_gathered_ = 0;
  turned_radps_ = 0.0;
  innovation_mps2_.setZero();
}

/// Turns the tilt by the rates of a step.
void AttitudeFilter::predict(const Imu& imu, double time_s) {
  const Eigen::Vector3d rate =
      Eigen::Map<const Eigen::Vector3d>(imu.angular_rate_radps.data()) - state_.segment<3>(kBiases);
  const double cr = std::cos(state_(0)), sr = std::sin(state_(0));
  const double tp = std::tan(state_(1)), cp = std::cos(state_(1));
  Matrix6 F = Matrix6::Identity();
  F.block<2, 3>(0, kBiases) << -time_s, -time_s * tp * sr, -time_s * tp * cr,  //
      0.0, -time_s * cr, time_s * sr;
  F(0, 0) += time_s * tp * (rate.y() * cr - rate.z() * sr);
  F(0, 1) = time_s * (rate.y() * sr + rate.z() * cr) / square(cp);
  F(1, 0) = -time_s * (rate.y() * sr + rate.z() * cr);
  state_(0) += time_s * (rate.x() + tp * (rate.y() * sr + rate.z() * cr));
  state_(1) += time_s * (rate.y() * cr - rate.z() * sr);
  const double held = has_wheels(imu.utime) ? 1.0 : std::exp(-time_s / kSpeedHeld_s);
  F(kSpeed, kSpeed) = held;
  state_(kSpeed) *= held;
  covariance_ = (F * covariance_ * F.transpose()).eval();
  covariance_(kSpeed, kSpeed) += square(kSpeedSd_mps) * (1.0 - square(held));
  const double rate_variance =
      imu.angular_rate_variance > 0.0 ? imu.angular_rate_variance : square(kRateSd_radps);
  covariance_.diagonal().head<2>().array() += rate_variance * square(time_s);
  covariance_.diagonal().segment<3>(kBiases).array() += square(kRateBiasWalk_radps) * time_s;
}

/// What gravity adds to the specific force along base's x and y.
Eigen::Vector2d AttitudeFilter::gravity_xy_mps2() const {
  return kGravity_mps2 *
         Eigen::Vector2d(-std::sin(state_(1)), std::sin(state_(0)) * std::cos(state_(1)));
}

/// Adds a sample to the mean of the specific force, without the robot's own acceleration: along x
/// only wheels tell it, along y it is what turns the speed.
void AttitudeFilter::gather(const Imu& imu, double time_s) {
  Eigen::Vector2d force(imu.acceleration_mps2[0], imu.acceleration_mps2[1]);
  const double turn_radps = imu.angular_rate_radps[2];
  force -= Eigen::Vector2d(has_wheels(imu.utime) ? acceleration_mps2_ : 0.0,
                           state_(kSpeed) * turn_radps);
  innovation_mps2_ += force - gravity_xy_mps2();
  turned_radps_ += turn_radps;
  ++num_gathered_;
  gathered_s_ += time_s;
  if (gathered_s_ >= kMean_s) correct();
}

/// Corrects the tilt by a mean of the force, and learns the noise of means.
void AttitudeFilter::correct() {
  const Eigen::Vector2d innovation = innovation_mps2_ / num_gathered_;
  const double turn_radps = turned_radps_ / num_gathered_;
  innovation_mps2_.setZero();
  turned_radps_ = 0.0;
  num_gathered_ = 0;
  gathered_s_ = 0.0;
  const double cr = std::cos(state_(0)), sr = std::sin(state_(0));
  const double cp = std::cos(state_(1)), sp = std::sin(state_(1));
  Eigen::Matrix<double, 2, 6> H = Eigen::Matrix<double, 2, 6>::Zero();
  H(0, 1) = -kGravity_mps2 * cp;
  H(1, 0) = kGravity_mps2 * cr * cp;
  H(1, 1) = -kGravity_mps2 * sr * sp;
  H(1, kSpeed) = turn_radps;
  const Eigen::Matrix2d predicted = H * covariance_ * H.transpose();
  if (predicted.trace() < 2.0 * force_variance_) {  // else the tilt is what is not known
    num_means_ = std::min(num_means_ + 1, kMeansMax);
    const double seen = std::max(0.0, 0.5 * (innovation.squaredNorm() - predicted.trace()));
    force_variance_ += (seen - force_variance_) / (num_means_ + 1);
  }
  Eigen::Matrix2d total = predicted;
  total.diagonal().array() += std::max(force_variance_, square(0.1 * kForceBiasSd_mps2));
  const Eigen::Matrix<double, 6, 2> gain = covariance_ * H.transpose() * total.inverse();
  state_ += gain * innovation;
  covariance_ -= (gain * H * covariance_).eval();
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
}

double AttitudeFilter::sd_rad() const {
  return std::sqrt(0.5 * std::max(0.0, covariance_(0, 0) + covariance_(1, 1)) +
                   square(kForceBiasSd_mps2 / kGravity_mps2));
}

std::optional<Attitude> AttitudeFilter::at(std::int64_t utime) const {
  const auto after =
      std::lower_bound(samples_.begin(), samples_.end(), utime,
                       [](const Sample& s, std::int64_t time) { return s.utime < time; });
  if (after == samples_.end()) {
    if (samples_.empty() || utime - samples_.back().utime > kFresh_us) return std::nullopt;
    return samples_.back().attitude;
  }
  if (after->utime == utime || after == samples_.begin()) {
    if (after->utime - utime > kFresh_us) return std::nullopt;
    return after->attitude;
  }
  const Sample& before = *std::prev(after);
  if (after->utime - before.utime > 2 * kFresh_us) return std::nullopt;
  const double f =
      static_cast<double>(utime - before.utime) / static_cast<double>(after->utime - before.utime);
  const Attitude &a = before.attitude, &b = after->attitude;
  return Attitude{a.roll_rad + f * (b.roll_rad - a.roll_rad),
                  a.pitch_rad + f * (b.pitch_rad - a.pitch_rad), std::max(a.sd_rad, b.sd_rad)};
}

}  // namespace orchard::pose
