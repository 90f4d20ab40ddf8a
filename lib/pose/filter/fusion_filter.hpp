// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Prior standard deviation of the gyro bias [rad/s]; physical: typical of MEMS gyros.
inline constexpr double kGyroBiasSd_radps = 0.02;

/// Measured motion of base over a short time.
struct MotionStep {
  double dt_s = 0.0;            ///< negative: back to where the robot came from
  double speed_mps = 0.0;       ///< by the wheels
  double yaw_rate_radps = 0.0;  ///< by the wheels or the gyro
  double speed_sd_mps = 0.0;
  double yaw_rate_sd_radps = 0.0;
  bool is_gyro = false;  ///< the yaw rate is by the gyro
};

/// Process noise of the wheels' errors.
struct WheelErrorNoise {
  double slip_sd = 0.02;        ///< of the slip, as a fraction of the travel
  double turn_slip_sd = 0.05;   ///< of the slip in turns, as a fraction of the turn
  double slip_travel_m = 10.0;  ///< correlation lengths of both
  double turn_slip_travel_m = 10.0;
  double curvature_walk = 2e-4;  ///< random walk of the turn per metre over travel [1/m/sqrt(m)]
};

/// Measured position of a point of base.
struct PositionObservation {
  Eigen::Vector2d p_map_m = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Vector2d p_base_m = Eigen::Vector2d::Zero();  ///< the measured point, e.g. the antenna
  bool is_gnss = false;       ///< by GNSS: contains the receiver's slow error, too
  bool is_displaced = false;  ///< contains the displacement of the filter's state, too
};

/// Extended Kalman filter over the pose of base and the errors of its sensors. State: x, y, yaw in
/// map; the wheels' scale error; their turn per metre (unequal wheels, steering offset) [1/m]; the
/// gyro bias [rad/s]; the scale error of the wheels' turns; the slip of the present ground, along
/// the path and in turns; the receiver's slow error to the east and north [m]; the displacement of
/// positions at present, e.g. by reflected signals [m].
class FusionFilter {
 public:
  static constexpr int kSize = 13;  // derived: the states above
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  /// Starts at the map's origin without uncertainty; priors of the sensor errors are configured.
  explicit FusionFilter(const FusionConfig& config);

  const Vector& mean() const { return mean_; }
  const Matrix& covariance() const { return covariance_; }

  /// Returns the position in map of a point of base [m].
  Eigen::Vector2d p_map_m(const Eigen::Vector2d& p_base_m) const;

  /// Returns the errors at present: speed scale with the slip, turn per metre [1/m], gyro bias
  /// [rad/s].
  Eigen::Vector3d sensor_errors() const;

  /// Predicts the motion of one step along an arc; its noise has the correlation time kNoiseTime_s.
  void move(const MotionStep& step);

  /// Sets the process noise of the wheels' errors, learnt from the drive.
  void set_wheel_error_noise(const WheelErrorNoise& changes) { changes_ = changes; }

  /// Sets the variance of the receiver's slow error, per axis [m2]; initially 0.
  void set_receiver_variance(double variance) { receiver_variance_ = variance; }

  double receiver_variance() const { return receiver_variance_; }

  /// Resets the receiver's slow error to its prior.
  void reset_receiver_error();

  /// Adds these variances [m2 per axis, rad2] to the pose, for motion that was not measured.
  void inflate_covariance(double position_variance, double yaw_variance);

  /// Sets the pose of base, uncorrelated with the sensor errors.
  void place(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance);

  /// Sets the pose of base and the receiver's error to the result of a whole solve. Both are
  /// correlated so that their sum, the last measured position, is known well.
  void set_smoothed_pose(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance,
                         const Eigen::Vector2d& receiver_error_m);

  /// Begins a displacement of positions with this variance per axis [m2], in place of an earlier
  /// one.
  void begin_displacement(double variance);
  void end_displacement() { begin_displacement(0.0); }

  /// Decorrelates the heading from the position if linearising the heading errs by more than this
  /// variance of a fix [m2]: the positions then lie on an arc, which a Gaussian cannot represent.
  /// Returns true if it did.
  bool decorrelate_unknown_heading(double variance);

  /// Sets the heading, which must be uncorrelated.
  void set_heading(double yaw_rad, double variance);

  /// Returns the squared Mahalanobis distance of the innovation; 2 degrees of freedom.
  double mahalanobis2(const PositionObservation& observation) const;

  /// Returns the distance of an observation from the expected one [m].
  double off_m(const PositionObservation& observation) const;

  /// Returns the log-likelihood of an observation, up to a constant, if its noise per axis has this
  /// additional variance [m2].
  double log_likelihood(const PositionObservation& observation, double added_variance) const;

  void correct(const PositionObservation& observation);
  void correct_yaw(double yaw_rad, double variance);

  /// Corrects the gyro bias by the gyro's rate while the robot stands.
  void correct_gyro_bias(double rate_radps, double variance);

 private:
  /// Corrects by a measurement of one state.
  void correct_state(int index, double innovation, double variance);
  /// Corrects by a gain K: its change of the mean, A = I - K H, and K R K^T.
  void update(const Vector& change, const Matrix& A, const Matrix& noise);
  void restart(int first, double variance);
  Eigen::Matrix<double, 2, kSize> jacobian(const PositionObservation& observation) const;
  Eigen::Vector2d innovation(const PositionObservation& observation) const;
  Eigen::Matrix2d noise(const PositionObservation& observation) const;
  Eigen::Matrix2d innovation_covariance(const PositionObservation& observation) const;

  FusionConfig config_;
  WheelErrorNoise changes_;
  double receiver_variance_ = 0.0;
  Vector mean_ = Vector::Zero();
  Matrix covariance_ = Matrix::Zero();
};

}  // namespace orchard::pose
