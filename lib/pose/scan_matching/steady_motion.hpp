// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace orchard::pose {

/// Returns the covariance of a motion of base (x, y, yaw) of which nothing is known [m2, m2, rad2].
Eigen::Matrix3d unknown_motion();

/// What a robot does until the next scan if nothing measures it: its last motion once more, per
/// second or per scan (time stamps of recordings may be stretched), whichever has foretold this
/// drive better.
class SteadyMotion {
 public:
  struct Forecast {
    Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();  ///< x [m], y [m], yaw [rad]
    Eigen::Matrix3d covariance = unknown_motion();        ///< of it, by the forecasts so far
  };

  /// Returns what base does in the next `dt_s` [s], above 0, in its axes before. Until
  /// three motions were seen, its covariance is unknown_motion().
  Forecast forecast(double dt_s) const;

  /// Takes the motion of base of the last `dt_s` [s], above 0, in its axes before: x [m], y [m],
  /// yaw [rad]. `is_seen`: a scan told it, so the forecasts are judged by it.
  void add(const Eigen::Vector3d& T_from_to, double dt_s, bool is_seen);

  /// Returns the last motion that was added: x [m], y [m], yaw [rad]; none: zero.
  const Eigen::Vector3d& last() const { return last_; }

 private:
  /// Squared errors of forecasts, summed: of the shift, per axis, and of the turn.
  struct Errors {
    double shift_m2 = 0.0, turn_rad2 = 0.0;
    void add(const Eigen::Vector3d& error, double forgetting);
  };

  Eigen::Vector3d per_second(double dt_s) const { return way_ * (dt_s / way_s_); }

  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  /// Motion of the last second or so, and its time; a single one may be short and noisy.
  Eigen::Vector3d way_ = Eigen::Vector3d::Zero();
  double way_s_ = 1.0;
  int num_unseen_ = 0;       ///< motions since the last that was seen
  double longest_s_ = 0.0;   ///< of the motions that were seen: nobody knows of longer ones
  double num_judged_ = 0.0;  ///< of the last some scans
  Errors of_scan_, of_second_;
  Errors rate_;  ///< of_second_ over the squared time: the error grows with it
};

}  // namespace orchard::pose
