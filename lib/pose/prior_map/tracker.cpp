// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/tracker.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;
using geometry::inverse_transform;
using geometry::rotation;
using geometry::transform;
namespace {

// physical: slip besides the wheels' covariance [m/sqrt(m)]; a headland turn, a half circle from
// one alley to the next; the wheels' errors wander by their prior within hours, here as a fraction
// of it per root second.
constexpr double kDrift_m_per_sqrt_m = 0.01;
constexpr double kTurnTravelM = 6.0;
constexpr double kTurnS = 6.0;
constexpr double kWander = 0.01;

// derived: quantile of the gate, less than the distance of two trees; a width differs by five
// standard deviations and what grows in a year; a landmark is expected if it is seen mostly.
constexpr double kTrackGate2 = geometry::kChiSquare2_997;
constexpr double kTrackGate_m = 1.0;
constexpr double kWidthSigma = 5.0;
constexpr double kWidthSlackM = 0.15;
constexpr double kSureRepeat = 0.5;

}  // namespace

void TreeDetectionMonitor::add(std::vector<ExpectedLandmark> scan) {
  scans_.push_back(std::move(scan));
  if (scans_.size() > kScans) scans_.pop_front();
}

TreeDetectionMonitor::Count TreeDetectionMonitor::count() const {
  std::vector<ExpectedLandmark> all;
  for (const auto& scan : scans_) all.insert(all.end(), scan.begin(), scan.end());
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.landmark < b.landmark; });
  Count count;
  for (auto begin = all.begin(), end = begin; begin != all.end(); begin = end) {
    while (end != all.end() && end->landmark == begin->landmark) ++end;
    if (end - begin < kSureScans) continue;
    ++count.num_trees;
    const auto seen = std::count_if(begin, end, [](const auto& e) { return e.seen; });
    count.num_detected += 2 * seen >= end - begin;
  }
  return count;
}

PriorMapTracker::PriorMapTracker(const PriorMap& map, const PriorMapConfig& config)
    : map_(map), config_(config) {
  const Eigen::Vector3d sd(config.speed_scale_sd, config.turn_scale_sd,
                           config.yaw_rate_bias_sd_radps);
  P_.bottomRightCorner<3, 3>() = sd.cwiseAbs2().asDiagonal();
}

void PriorMapTracker::start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance) {
  x_.head<3>() = T_map_base;
  P_.topRightCorner<3, 3>().setZero();
  P_.bottomLeftCorner<3, 3>().setZero();
  P_.topLeftCorner<3, 3>() = covariance;
}

Eigen::Vector3d PriorMapTracker::motion(const WheelStep& step) const {
  const double length_m = (1.0 - x_(3)) * step.speed_mps * step.dt_s;
  const double turn_rad = ((1.0 - x_(4)) * step.yaw_rate_radps - x_(5)) * step.dt_s;
  return {length_m * std::cos(0.5 * turn_rad), length_m * std::sin(0.5 * turn_rad), turn_rad};
}

Eigen::Matrix3d PriorMapTracker::motion_covariance(const WheelStep& step) const {
  const double speed_mps = std::abs(step.speed_mps);
  WheelStep unlearnt = step;
  unlearnt.covariance[0] += P_(3, 3) * speed_mps * kTurnTravelM / step.dt_s;
  unlearnt.covariance[2] +=
      (P_(4, 4) * std::abs(step.yaw_rate_radps) * geometry::kPi + P_(5, 5) * kTurnS) / step.dt_s;
  return noise(unlearnt);
}

Eigen::Matrix3d PriorMapTracker::noise(const WheelStep& step) const {
  const Eigen::Vector3d delta = motion(step);
  const double dt = step.dt_s;
  const double half_rad = 0.5 * delta.z();
  Eigen::Matrix<double, 3, 2> G;
  G << dt * std::cos(half_rad), -0.5 * dt * delta.y(), dt * std::sin(half_rad),
      0.5 * dt * delta.x(), 0.0, dt;
  Eigen::Matrix2d Q;
  Q << step.covariance[0], step.covariance[1], step.covariance[1], step.covariance[2];
  Eigen::Matrix3d C = G * Q * G.transpose();
  C.topLeftCorner<2, 2>() += kDrift_m_per_sqrt_m * kDrift_m_per_sqrt_m * std::abs(step.speed_mps) *
                             dt * Eigen::Matrix2d::Identity();
  return C;
}

void PriorMapTracker::move(const WheelStep& step) {
  const Eigen::Vector3d delta = motion(step);
  const Eigen::Matrix3d C = noise(step);
  const Eigen::Vector3d T = x_.head<3>();
  const Eigen::Matrix3d G = compose_jacobian_second(T);
  Eigen::Matrix3d E = Eigen::Matrix3d::Zero();  // d(delta) / d(errors of the wheels)
  const double half_rad = 0.5 * delta.z();
  const double length_m = step.speed_mps * step.dt_s;
  E.col(0) << -length_m * std::cos(half_rad), -length_m * std::sin(half_rad), 0.0;
  const Eigen::Vector3d turn(-0.5 * delta.y(), 0.5 * delta.x(), 1.0);
  E.col(1) = -step.yaw_rate_radps * step.dt_s * turn;
  E.col(2) = -step.dt_s * turn;

  Covariance F = Covariance::Identity();
  F.topLeftCorner<3, 3>() = compose_jacobian_first(T, delta);
  F.topRightCorner<3, 3>() = G * E;
  P_ = (F * P_ * F.transpose()).eval();
  P_.topLeftCorner<3, 3>() += G * C * G.transpose();
  const Eigen::Vector3d sd(config_.speed_scale_sd, config_.turn_scale_sd,
                           config_.yaw_rate_bias_sd_radps);
  // Random walk of the wheels' errors, limited to the prior variance.
  for (int i = 0; i < 3; ++i) {
    double& variance = P_(3 + i, 3 + i);
    const double wandered = variance + std::pow(kWander * sd(i), 2) * step.dt_s;
    variance = std::max(variance, std::min(wandered, sd(i) * sd(i)));
  }
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  x_.head<3>() = compose(T, delta);
}

void PriorMapTracker::move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d T = x_.head<3>();
  const Eigen::Matrix3d G = compose_jacobian_second(T);
  Covariance F = Covariance::Identity();
  F.topLeftCorner<3, 3>() = compose_jacobian_first(T, T_base_next);
  P_ = (F * P_ * F.transpose()).eval();
  P_.topLeftCorner<3, 3>() += G * covariance * G.transpose();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  x_.head<3>() = compose(T, T_base_next);
}

Eigen::Matrix<double, 2, 6> PriorMapTracker::jacobian(const ScanObservation& observation) const {
  Eigen::Matrix<double, 2, 6> H = Eigen::Matrix<double, 2, 6>::Zero();
  H.leftCols<3>() = geometry::point_jacobian(rotation(x_(2)) * observation.p_base);
  return H;
}

PriorMapTracker::Match PriorMapTracker::best_match(const ScanObservation& observation,
                                                   const std::vector<std::int32_t>& taken) const {
  const Eigen::Matrix<double, 2, 6> H = jacobian(observation);
  const Eigen::Matrix2d R = rotation(x_(2));
  const double map_variance = PriorMapConfig::kLandmarkSd_m * PriorMapConfig::kLandmarkSd_m;
  const Eigen::Matrix2d S = H * P_ * H.transpose() + R * observation.covariance * R.transpose() +
                            map_variance * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d p_map = transform(x_.head<3>(), observation.p_base);
  Match best;
  double second_d2 = kTrackGate2 + kRivalGap;
  best.d2 = second_d2;
  map_.near(p_map, kTrackGate_m, [&](std::int32_t i) {
    const Eigen::Vector2d r = map_[i].p_map - p_map;
    const double own_variance = map_[i].sd_m * map_[i].sd_m;
    const double d2 = r.dot((S + own_variance * Eigen::Matrix2d::Identity()).inverse() * r);
    const double width_m = map_[i].width_m;
    const bool other_size = observation.width_m > 0.0 && width_m > 0.0 &&
                            std::abs(observation.width_m - width_m) >
                                kWidthSlackM + kWidthSigma * observation.width_sd_m;
    if (r.norm() > kTrackGate_m || other_size) return;
    if (std::find(taken.begin(), taken.end(), i) != taken.end()) return;
    if (d2 < best.d2) {
      second_d2 = best.d2;
      best = {i, d2, r};
    } else {
      second_d2 = std::min(second_d2, d2);
    }
  });
  if (best.d2 > kTrackGate2 || second_d2 - best.d2 < kRivalGap) best.landmark = -1;
  return best;
}

void PriorMapTracker::update(const ScanObservation& observation, const Match& match) {
  const Eigen::Matrix<double, 2, 6> H = jacobian(observation);
  const Eigen::Matrix2d R = rotation(x_(2));
  const double own_sd_m = map_[match.landmark].sd_m;
  const double map_variance =
      (PriorMapConfig::kLandmarkSd_m * PriorMapConfig::kLandmarkSd_m + own_sd_m * own_sd_m) *
      kSightingsPerTree;
  const Eigen::Matrix2d N =
      R * observation.covariance * R.transpose() + map_variance * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 6, 2> PHt = P_ * H.transpose();
  const Eigen::Matrix<double, 6, 2> K = PHt * (H * PHt + N).inverse();
  x_ += K * match.innovation;
  x_(2) = geometry::wrap_angle_rad(x_(2));
  // Joseph's form keeps the covariance positive definite despite rounding of the gain.
  const Covariance A = Covariance::Identity() - K * H;
  P_ = (A * P_ * A.transpose() + K * N * K.transpose()).eval();
}

PriorMapTracker::Matching PriorMapTracker::correct(const std::vector<ScanObservation>& observations,
                                                   const FieldOfView& field) {
  Matching matching;
  std::vector<std::int32_t> taken;
  // Best match first: it narrows the gates of the others.
  std::vector<std::pair<double, const ScanObservation*>> by_distance;
  for (const ScanObservation& observation : observations) {
    const Match match = best_match(observation, taken);
    by_distance.emplace_back(match.landmark < 0 ? 2.0 * kTrackGate2 : match.d2, &observation);
  }
  std::stable_sort(by_distance.begin(), by_distance.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [d2, observation] : by_distance) {
    const Match match = best_match(*observation, taken);
    if (match.landmark < 0) continue;
    update(*observation, match);
    taken.push_back(match.landmark);
    ++matching.num_matched;
  }

  const geometry::OcclusionTest occlusion = occlusion_by(observations);
  const Eigen::Vector3d T = x_.head<3>();
  map_.near(T.head<2>(), field.range_m(), [&](std::int32_t i) {
    const Eigen::Vector2d p_base = inverse_transform(T, map_[i].p_map);
    if (map_.repeat(i) < kSureRepeat || !field.covers(p_base) || occlusion.occludes(p_base)) return;
    matching.expected.push_back({i, std::find(taken.begin(), taken.end(), i) != taken.end()});
  });
  return matching;
}

}  // namespace orchard::pose
