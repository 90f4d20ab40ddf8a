// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/fusion_filter.hpp"

#include <Eigen/LU>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {
namespace {

// Priors of the wheels' errors and their random walks. physical: unequal wheels or a steering
// offset turn so much per metre; the effective track width is a tenth off on soft ground and for
// skid steering; tyres and loads change slowly compared with the ground; data sheets of MEMS gyros.
constexpr double kCurvatureSd_per_m = 0.02;
constexpr double kTurnScaleSd = 0.1;
constexpr double kScaleWalk_per_sqrt_m = 1e-4;
constexpr double kGyroWalk_radps_per_sqrt_s = 1e-5;
/// Correlation time of the errors of speed and yaw rate [s], which converts their variances into
/// spectral densities; physical: a wheel's turn over a clod.
constexpr double kNoiseTime_s = 0.1;

enum Index {
  kX = 0,
  kY = 1,
  kYaw = 2,
  kScale = 3,
  kCurvature = 4,
  kGyroBias = 5,
  kTurnScale = 6,
  kSlip = 7,
  kTurnSlip = 8,
  kReceiverEast = 9,
  kReceiverNorth = 10,
  kDisplacedEast = 11,
  kDisplacedNorth = 12
};

/// A matrix of any size up to the state's, without memory of the heap.
using Sized = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                            FusionFilter::kSize, FusionFilter::kSize>;

/// Returns A B. One function for all sizes: the compiler needs seconds for every pair of fixed
/// ones.
Sized product(const Sized& A, const Sized& B) { return A * B; }

/// sin(a) / a
double sinc(double a) { return std::abs(a) < 1e-4 ? 1.0 - a * a / 6.0 : std::sin(a) / a; }

/// Returns the variance of linearising the heading, given its covariance with a position: a heading
/// error a over a path of length L displaces the position by L a^2 / 2 beyond the linear model,
/// with mean square 0.75 L^2 var(a)^2; the covariance is L var(a).
double bent_variance(const Eigen::Vector2d& covariance) { return 0.75 * covariance.squaredNorm(); }

}  // namespace

FusionFilter::FusionFilter(const FusionConfig& config) : config_(config) {
  if (!config.learns_wheels) {
    changes_ = {0.0, 0.0, changes_.slip_travel_m, changes_.turn_slip_travel_m, 0.0};
    return;
  }
  covariance_(kScale, kScale) = geometry::square(config.speed_scale_sd);
  covariance_(kCurvature, kCurvature) = geometry::square(kCurvatureSd_per_m);
  covariance_(kGyroBias, kGyroBias) = geometry::square(kGyroBiasSd_radps);
  covariance_(kTurnScale, kTurnScale) = geometry::square(kTurnScaleSd);
  covariance_(kSlip, kSlip) = geometry::square(changes_.slip_sd);
  covariance_(kTurnSlip, kTurnSlip) = geometry::square(changes_.turn_slip_sd);
}

Eigen::Vector2d FusionFilter::p_map_m(const Eigen::Vector2d& p_base_m) const {
  return geometry::transform(Eigen::Vector3d(mean_.head<3>()), p_base_m);
}

Eigen::Vector3d FusionFilter::sensor_errors() const {
  return {mean_(kScale) + mean_(kSlip), mean_(kCurvature), mean_(kGyroBias)};
}

void FusionFilter::move(const MotionStep& step) {
  const double dt_s = step.dt_s, duration_s = std::abs(dt_s);
  const double wheels_m = step.speed_mps * dt_s;
  const double length_m = (1.0 + mean_(kScale) + mean_(kSlip)) * wheels_m;
  const double measured_rad = step.yaw_rate_radps * dt_s;
  const double turn_rad = step.is_gyro
                              ? measured_rad - mean_(kGyroBias) * dt_s
                              : (1.0 + mean_(kTurnScale) + mean_(kTurnSlip)) * measured_rad +
                                    mean_(kCurvature) * length_m;
  // Exact for an arc: its chord points half the turn aside and is shorter by the sinc of that.
  const double heading_rad = mean_(kYaw) + 0.5 * turn_rad;
  const Eigen::Vector2d along(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const double chord = sinc(0.5 * turn_rad);
  mean_.head<2>() += length_m * chord * along;
  mean_(kYaw) = geometry::wrap_angle_rad(mean_(kYaw) + turn_rad);

  Vector length_by = Vector::Zero();
  length_by(kScale) = length_by(kSlip) = wheels_m;
  Vector turn_by = Vector::Zero();
  if (step.is_gyro) {
    turn_by(kGyroBias) = -dt_s;
  } else {
    turn_by(kCurvature) = length_m;
    turn_by(kScale) = turn_by(kSlip) = mean_(kCurvature) * wheels_m;
    turn_by(kTurnScale) = turn_by(kTurnSlip) = measured_rad;
  }
  Vector heading_by = 0.5 * turn_by;
  heading_by(kYaw) += 1.0;
  // The step adds to the three rows of the pose alone: F = diag(kept) (I + pose_by in those rows).
  Eigen::Matrix<double, 3, kSize> pose_by;
  pose_by.topRows<2>() =
      chord * along * length_by.transpose() + length_m * chord * across * heading_by.transpose();
  pose_by.row(kYaw) = turn_by.transpose();

  // Time-correlated errors are Ornstein-Uhlenbeck processes: a decay here, new noise below.
  const double slip_kept = std::exp(-std::abs(wheels_m) / changes_.slip_travel_m);
  const double turn_slip_kept = std::exp(-std::abs(wheels_m) / changes_.turn_slip_travel_m);
  const double receiver_kept = std::exp(-duration_s / kReceiverMemory_s);
  Vector kept = Vector::Ones();
  kept(kSlip) = slip_kept;
  kept(kTurnSlip) = turn_slip_kept;
  kept(kReceiverEast) = kept(kReceiverNorth) = receiver_kept;
  mean_ = kept.cwiseProduct(mean_);

  Eigen::Matrix<double, kSize, 2> G = Eigen::Matrix<double, kSize, 2>::Zero();
  G.block<2, 1>(0, 0) = chord * along;
  G.block<2, 1>(0, 1) = 0.5 * length_m * chord * across;
  G(kYaw, 1) = 1.0;
  const double noise_s2 = (config_.learns_wheels ? kNoiseTime_s : duration_s) * duration_s;
  const Eigen::Vector2d noise(geometry::square(step.speed_sd_mps) * noise_s2,
                              geometry::square(step.yaw_rate_sd_radps) * noise_s2);
  covariance_.topRows<3>() += product(pose_by, covariance_);
  covariance_.leftCols<3>() += product(covariance_, pose_by.transpose());
  covariance_ = kept.asDiagonal() * covariance_ * kept.asDiagonal();
  covariance_ += product(G, (G * noise.asDiagonal()).transpose()).transpose();
  const double walk =
      config_.learns_wheels ? geometry::square(kScaleWalk_per_sqrt_m) * std::abs(length_m) : 0.0;
  covariance_(kScale, kScale) += walk;
  covariance_(kTurnScale, kTurnScale) += walk;
  covariance_(kCurvature, kCurvature) +=
      geometry::square(changes_.curvature_walk) * std::abs(length_m);
  covariance_(kGyroBias, kGyroBias) += geometry::square(kGyroWalk_radps_per_sqrt_s) * duration_s;
  covariance_(kSlip, kSlip) +=
      (1.0 - geometry::square(slip_kept)) * geometry::square(changes_.slip_sd);
  covariance_(kTurnSlip, kTurnSlip) +=
      (1.0 - geometry::square(turn_slip_kept)) * geometry::square(changes_.turn_slip_sd);
  const double receiver_new = (1.0 - geometry::square(receiver_kept)) * receiver_variance_;
  covariance_(kReceiverEast, kReceiverEast) += receiver_new;
  covariance_(kReceiverNorth, kReceiverNorth) += receiver_new;
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
}

void FusionFilter::inflate_covariance(double position_variance, double yaw_variance) {
  covariance_(kX, kX) += position_variance;
  covariance_(kY, kY) += position_variance;
  covariance_(kYaw, kYaw) += yaw_variance;
}

void FusionFilter::place(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance) {
  mean_.head<3>() = x_y_yaw;
  mean_(kYaw) = geometry::wrap_angle_rad(mean_(kYaw));
  covariance_.topRows<3>().setZero();
  covariance_.leftCols<3>().setZero();
  covariance_.topLeftCorner<3, 3>() = covariance;
}

void FusionFilter::set_smoothed_pose(const Eigen::Vector3d& x_y_yaw,
                                     const Eigen::Matrix3d& covariance,
                                     const Eigen::Vector2d& receiver_error_m) {
  place(x_y_yaw, covariance);
  reset_receiver_error();
  if (receiver_variance_ <= 0.0) return;
  mean_.segment<2>(kReceiverEast) = receiver_error_m;
  const Eigen::Matrix2d P = covariance.topLeftCorner<2, 2>();
  covariance_.block<2, 2>(kReceiverEast, kReceiverEast) = P;
  covariance_.block<2, 2>(kX, kReceiverEast) = -P;
  covariance_.block<2, 2>(kReceiverEast, kX) = -P;
  covariance_.block<1, 2>(kYaw, kReceiverEast) = -covariance.block<1, 2>(2, 0);
  covariance_.block<2, 1>(kReceiverEast, kYaw) = -covariance.block<2, 1>(0, 2);
}

bool FusionFilter::decorrelate_unknown_heading(double variance) {
  const double bent2 = bent_variance(covariance_.block<2, 1>(kX, kYaw));
  if (bent2 <= variance) return false;
  covariance_.topLeftCorner<2, 2>() += bent2 * Eigen::Matrix2d::Identity();
  const double yaw_variance =
      std::min(covariance_(kYaw, kYaw), geometry::square(geometry::kPi) / 3.0);
  covariance_.row(kYaw).setZero();
  covariance_.col(kYaw).setZero();
  covariance_(kYaw, kYaw) = yaw_variance;
  return true;
}

void FusionFilter::set_heading(double yaw_rad, double variance) {
  mean_(kYaw) = geometry::wrap_angle_rad(yaw_rad);
  covariance_(kYaw, kYaw) = variance;
}

void FusionFilter::restart(int first, double variance) {
  mean_.segment<2>(first).setZero();
  covariance_.middleRows<2>(first).setZero();
  covariance_.middleCols<2>(first).setZero();
  covariance_.block<2, 2>(first, first) = variance * Eigen::Matrix2d::Identity();
}

void FusionFilter::reset_receiver_error() { restart(kReceiverEast, receiver_variance_); }

void FusionFilter::begin_displacement(double variance) { restart(kDisplacedEast, variance); }

Eigen::Matrix<double, 2, FusionFilter::kSize> FusionFilter::jacobian(
    const PositionObservation& observation) const {
  Eigen::Matrix<double, 2, kSize> H = Eigen::Matrix<double, 2, kSize>::Zero();
  H(0, kX) = H(1, kY) = 1.0;
  const Eigen::Vector2d arm = geometry::rotation(mean_(kYaw)) * observation.p_base_m;
  H.col(kYaw) = Eigen::Vector2d(-arm.y(), arm.x());
  if (observation.is_gnss) H(0, kReceiverEast) = H(1, kReceiverNorth) = 1.0;
  if (observation.is_displaced) H(0, kDisplacedEast) = H(1, kDisplacedNorth) = 1.0;
  return H;
}

Eigen::Vector2d FusionFilter::innovation(const PositionObservation& observation) const {
  Eigen::Vector2d off_m = observation.p_map_m - p_map_m(observation.p_base_m);
  if (observation.is_gnss) off_m -= mean_.segment<2>(kReceiverEast);
  if (observation.is_displaced) off_m -= mean_.segment<2>(kDisplacedEast);
  return off_m;
}

/// Returns the noise of an observation, plus the error of linearising the heading. Earlier
/// observations with the same slow error or displacement have shortened its lever arm.
Eigen::Matrix2d FusionFilter::noise(const PositionObservation& observation) const {
  Eigen::Vector2d arm = covariance_.block<2, 1>(kX, kYaw);
  if (observation.is_gnss) arm += covariance_.block<2, 1>(kReceiverEast, kYaw);
  if (observation.is_displaced) arm += covariance_.block<2, 1>(kDisplacedEast, kYaw);
  return observation.covariance + bent_variance(arm) * Eigen::Matrix2d::Identity();
}

double FusionFilter::off_m(const PositionObservation& observation) const {
  return innovation(observation).norm();
}

Eigen::Matrix2d FusionFilter::innovation_covariance(const PositionObservation& observation) const {
  const Eigen::Matrix<double, 2, kSize> H = jacobian(observation);
  const Eigen::Matrix<double, 2, kSize> HP = product(H, covariance_);
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> S;
  S.noalias() = HP.lazyProduct(H.transpose());
  return S + noise(observation);
}

double FusionFilter::log_likelihood(const PositionObservation& observation,
                                    double added_variance) const {
  const Eigen::Matrix2d S =
      innovation_covariance(observation) + added_variance * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d off_m = innovation(observation);
  return -0.5 * (off_m.dot(S.inverse() * off_m) + std::log(S.determinant()));
}

double FusionFilter::mahalanobis2(const PositionObservation& observation) const {
  const Eigen::Matrix2d S = innovation_covariance(observation);
  const Eigen::Vector2d off_m = innovation(observation);
  return off_m.dot(S.inverse() * off_m);
}

void FusionFilter::correct(const PositionObservation& observation) {
  const Eigen::Matrix<double, 2, kSize> H = jacobian(observation);
  const Eigen::Matrix2d R = noise(observation);
  const Eigen::Matrix2d S = innovation_covariance(observation);
  const Eigen::Matrix<double, kSize, 2> PHt = product(covariance_, H.transpose());
  const Eigen::Matrix<double, kSize, 2> K = PHt * S.inverse();
  const Vector change = K * innovation(observation);
  update(change, Matrix::Identity() - product(K, H), product(K, (K * R).transpose()));
}

void FusionFilter::correct_yaw(double yaw_rad, double variance) {
  correct_state(kYaw, geometry::wrap_angle_rad(yaw_rad - mean_(kYaw)), variance);
}

void FusionFilter::correct_gyro_bias(double rate_radps, double variance) {
  correct_state(kGyroBias, rate_radps - mean_(kGyroBias), variance);
}

void FusionFilter::correct_state(int index, double innovation, double variance) {
  const Vector K = covariance_.col(index) * (1.0 / (covariance_(index, index) + variance));
  Matrix A = Matrix::Identity();
  A.col(index) -= K;
  update(K * innovation, A, K * (K * variance).transpose());
}

void FusionFilter::update(const Vector& change, const Matrix& A, const Matrix& noise) {
  mean_ += change;
  mean_(kYaw) = geometry::wrap_angle_rad(mean_(kYaw));
  // Joseph's form keeps the covariance positive definite despite rounding of the gain.
  covariance_ = product(A, product(A, covariance_).transpose()) + noise;
  covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
}

}  // namespace orchard::pose
