// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/filter/fusion_config.hpp"

namespace orchard::pose {

/// Standard deviation of the gyro's bias before it is estimated [rad/s]: that of MEMS gyros.
inline constexpr double kGyroBiasSd_radps = 0.02;

/// How base moved over a short time, as measured.
struct MotionStep {
  double dt_s = 0.0;
  double speed_mps = 0.0;       ///< of the wheels
  double yaw_rate_radps = 0.0;  ///< of the wheels or of the gyro
  double speed_sd_mps = 0.0;
  double yaw_rate_sd_radps = 0.0;
  bool is_gyro = false;  ///< which of the two gave the yaw rate
};

/// How much what wheels are wrong by changes on the way.
struct WheelChanges {
  double slip_sd = 0.02;       ///< of the way, as the ground is: a few parts in a hundred on grass
  double turn_slip_sd = 0.05;  ///< of the turn, where wheels are dragged sideways
  double curvature_walk = 2e-4;  ///< of the turn per metre, over travel [1/m/sqrt(m)]
};

/// Travel over which the ground stays alike [m].
inline constexpr double kSlipTravel_m = 10.0;

/// A position that base's own is compared with.
struct PositionObservation {
  Eigen::Vector2d p_map_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Vector2d p_base_m = Eigen::Vector2d::Zero();  ///< what in base is there: the antenna
  bool by_receiver = false;  ///< by satellites: the receiver's slow error counts besides
};

/// An extended Kalman filter over where base is and what is wrong with its sensors: x, y, yaw in
/// map; the wheels' scale error; their turn per metre (unequal wheels, a steering offset) [1/m];
/// the gyro's bias [rad/s]; the scale of the wheels' turns; the slip of this patch of ground, of
/// the way and of the turn; the receiver's slow error to the east and north [m].
class FusionFilter {
 public:
  static constexpr int kSize = 11;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  /// At the map's origin, certain of it, with the configured doubts about the sensors.
  explicit FusionFilter(const FusionConfig& config);

  const Vector& mean() const { return mean_; }
  const Matrix& covariance() const { return covariance_; }

  /// Where a point of base is now [m].
  Eigen::Vector2d p_map_m(const Eigen::Vector2d& p_base_m) const;

  /// The motion of one step along an arc, its errors as constant over noise_time_s.
  void move(const MotionStep& step);

  /// What the drive has told of its wheels.
  void set_wheel_changes(const WheelChanges& changes) { changes_ = changes; }

  /// How large the receiver's slow error may be, per axis [m2]; 0 at first.
  void set_receiver_variance(double variance) { receiver_variance_ = variance; }

  double receiver_variance() const { return receiver_variance_; }

  /// Nothing is known any more of the receiver's slow error.
  void forget_receiver_error();

  /// Unheard motion: nothing moves, doubts grow by these variances [m2 per axis, rad2].
  void doubt(double position_variance, double yaw_variance);

  /// Puts base there, with no correlation to what is known of the sensors.
  void place(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance);

  /// Puts base where a whole solve has it, and with it what the receiver is wrong by: their sum,
  /// the last position, is known well.
  void adopt(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance,
             const Eigen::Vector2d& receiver_error_m);

  /// Where the heading has become unknown, what it would say of the position is dropped: an ellipse
  /// knows no circle.
  void forget_lost_heading();

  /// Squared Mahalanobis distance of what was seen from what was expected; 2 degrees of freedom.
  double distance2(const PositionObservation& observation) const;

  void correct(const PositionObservation& observation);
  void correct_yaw(double yaw_rad, double variance);

  /// The gyro's rate while the robot stands is its bias.
  void correct_gyro_bias(double rate_radps, double variance);

 private:
  template <int N>
  void apply(const Eigen::Matrix<double, N, 1>& innovation,
             const Eigen::Matrix<double, N, kSize>& H, const Eigen::Matrix<double, N, N>& R);
  Eigen::Matrix<double, 2, kSize> jacobian(const PositionObservation& observation) const;
  Eigen::Vector2d innovation(const PositionObservation& observation) const;
  Eigen::Matrix2d noise(const PositionObservation& observation) const;

  FusionConfig config_;
  WheelChanges changes_;
  double receiver_variance_ = 0.0;
  Vector mean_ = Vector::Zero();
  Matrix covariance_ = Matrix::Zero();
};

}  // namespace orchard::pose
