// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/steady_motion.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {
namespace {

// derived: forecasts are judged over some seconds of scans, as long as a turn lasts; fewer than
// three say nothing of a variance.
constexpr double kJudgedScans = 50.0;
constexpr double kJudgedMin = 3.0;

// physical: a robot changes its speed within about a second.
constexpr double kSteady_s = 1.0;

}  // namespace

Eigen::Matrix3d unknown_motion() {
  return Eigen::Vector3d(kUnknownShiftSd_m * kUnknownShiftSd_m,
                         kUnknownShiftSd_m * kUnknownShiftSd_m,
                         kUnknownTurnSd_rad * kUnknownTurnSd_rad)
      .asDiagonal();
}

void SteadyMotion::Errors::add(const Eigen::Vector3d& error, double forgetting) {
  shift_m2 += 0.5 * error.head<2>().squaredNorm() - forgetting * shift_m2;
  turn_rad2 += geometry::square(geometry::wrap_angle_rad(error.z())) - forgetting * turn_rad2;
}

SteadyMotion::Forecast SteadyMotion::forecast(double dt_s) const {
  Forecast forecast;
  const bool is_by_time = of_second_.shift_m2 < of_scan_.shift_m2;
  forecast.T_from_to = is_by_time ? per_second(std::min(dt_s, longest_s_)) : last_;
  if (num_judged_ < kJudgedMin) return forecast;
  const Errors& errors = is_by_time ? rate_ : of_scan_;
  // A robot that stops unseen is farther behind with every scan: these errors are one error.
  const double scans = 1.0 + num_unseen_;
  const double grown =
      geometry::square(is_by_time ? scans * std::min(dt_s, longest_s_) : scans) / num_judged_;
  const Eigen::Vector3d variance(errors.shift_m2, errors.shift_m2, errors.turn_rad2);
  forecast.covariance.diagonal() = forecast.covariance.diagonal().cwiseMin(grown * variance);
  return forecast;
}

void SteadyMotion::add(const Eigen::Vector3d& T_from_to, double dt_s, bool is_seen) {
  if (is_seen) {
    longest_s_ = std::max(longest_s_, dt_s);
    const double forgetting = num_judged_ < kJudgedScans ? 0.0 : 1.0 / kJudgedScans;
    num_judged_ = std::min(num_judged_ + 1.0, kJudgedScans);
    const Eigen::Vector3d error = T_from_to - per_second(dt_s);
    of_scan_.add(T_from_to - last_, forgetting);
    of_second_.add(error, forgetting);
    rate_.add(error / dt_s, forgetting);
  }
  num_unseen_ = is_seen ? 0 : num_unseen_ + 1;
  last_ = T_from_to;
  const double kept = std::exp(-dt_s / kSteady_s);
  way_ = T_from_to + kept * way_;
  way_s_ = dt_s + kept * way_s_;
}

}  // namespace orchard::pose
