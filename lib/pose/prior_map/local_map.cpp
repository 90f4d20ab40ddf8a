// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/local_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "timing/units.hpp"

namespace orchard::pose {

using geometry::between;
using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;
using geometry::inverse_transform;
using geometry::rotation;
using geometry::transform;
namespace {

// physical: a scan takes less; an observation farther from its scan's stamp is not corrected [s].
constexpr double kMaxScanS = 1.0;

// physical: two trunks stand farther apart, and a trunk's centre is seen within a step [m].
constexpr double kMatchM = 0.5;
constexpr double kNewTrunkM = 0.6;

// derived: quantile of the gate; what three scans show, and most of those that should, is real;
// what five in a row do not, or none of the last metres, is not.
constexpr double kLocalGate2 = geometry::kChiSquare2_999;
constexpr int kConfirmingObservations = 3;
constexpr double kSureFraction = 0.5;
constexpr int kMissedForgotten = 5;
constexpr double kUnsureTravelM = 3.0;

// derived: budgets, of a filter that costs the square of its trunks, and a view every half metre
// or as much turned.
constexpr std::size_t kMaxTrunks = 60;
constexpr std::size_t kMaxViews = 200;
constexpr double kViewTravelM = 0.5;
constexpr double kViewTurnRad = 0.3;

// derived: fewer than three trunks judge nothing, and less than a third of them seen is not by
// chance. A trunk first seen after the robot was carried would confirm the wrong motion, so that
// only older ones judge it.
constexpr int kJudgedTrunks = 3;
constexpr double kBrokenFraction = 0.34;
constexpr int kOldScans = 10;
constexpr int kSurprises = 3;

}  // namespace

std::vector<ScanObservation> scan_observations(const detection::Detections& seen, double speed_mps,
                                               double yaw_rate_radps,
                                               const PriorMapConfig& config) {
  std::vector<ScanObservation> observations;
  observations.reserve(seen.trunks.size());
  const double sd2 = config.observation_sd_m * config.observation_sd_m;
  for (const detection::Detection& trunk : seen.trunks) {
    ScanObservation s;
    s.p_base = {trunk.centre_x_m, trunk.centre_y_m};
    s.covariance << trunk.covariance[0], trunk.covariance[1], trunk.covariance[1],
        trunk.covariance[2];
    const bool sound = s.p_base.allFinite() && s.covariance.allFinite() &&
                       s.covariance(0, 0) >= 0.0 && s.covariance(1, 1) >= 0.0 &&
                       s.covariance.determinant() >= 0.0 && std::isfinite(trunk.width_m);
    if (!sound || s.p_base.norm() > config.observation_range_max_m) continue;
    s.covariance += sd2 * Eigen::Matrix2d::Identity();
    s.width_m = std::max(0.0, trunk.width_m);
    s.width_sd_m = std::isfinite(trunk.width_sd_m) ? std::max(0.0, trunk.width_sd_m) : 1.0;
    const double dt_s = timing::seconds(trunk.utime - seen.utime);
    if (std::abs(dt_s) <= kMaxScanS) {
      const double turn_rad = yaw_rate_radps * dt_s;
      const Eigen::Vector3d T_scan_then(speed_mps * dt_s * std::cos(0.5 * turn_rad),
                                        speed_mps * dt_s * std::sin(0.5 * turn_rad), turn_rad);
      s.p_base = transform(T_scan_then, s.p_base);
      const Eigen::Matrix2d R = rotation(turn_rad);
      s.covariance = R * s.covariance * R.transpose();
    }
    observations.push_back(s);
  }
  return observations;
}

LocalTrunkMap::LocalTrunkMap(const PriorMapConfig& config) : config_(config) { clear(); }

void LocalTrunkMap::clear() {
  x_ = Eigen::VectorXd::Zero(3);
  P_ = Eigen::MatrixXd::Zero(3, 3);
  T_local_base_.setZero();
  pose_covariance_.setZero();
  entries_.clear();
  views_.clear();
  num_inconsistent_scans_ = 0;
  last_scan_contradicts_ = false;
}

void LocalTrunkMap::move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance,
                         double travel_m) {
  const Eigen::Matrix3d F = compose_jacobian_first(T_local_base_, T_base_next);
  const Eigen::Matrix3d G = compose_jacobian_second(T_local_base_);
  T_local_base_ = compose(T_local_base_, T_base_next);
  x_.head<3>() = T_local_base_;
  P_.topRows<3>() = (F * P_.topRows<3>()).eval();
  P_.leftCols<3>() = (P_.leftCols<3>() * F.transpose()).eval();
  P_.topLeftCorner<3, 3>() += G * covariance * G.transpose();
  pose_covariance_ = P_.topLeftCorner<3, 3>();
  travel_m_ += travel_m;
}

void LocalTrunkMap::observe(const std::vector<ScanObservation>& observations,
                            const FieldOfView& field) {
  const geometry::OcclusionTest occlusion = occlusion_by(observations);
  const std::size_t num_before = entries_.size();
  std::vector<bool> taken(num_before, false);
  std::vector<const ScanObservation*> fresh;
  int num_matched = 0, num_surprises = 0;
  for (const ScanObservation& observation : observations) {
    double nearest_m = kNewTrunkM;
    const int trunk = match(observation, taken, nearest_m);
    if (trunk >= 0) {
      taken[trunk] = true;
      correct(trunk, observation);
      ++num_matched;
      continue;
    }
    // Contradiction: seen beside a known trunk, or in covered space without a known trunk.
    const bool beside = nearest_m < kNewTrunkM;
    num_surprises += beside || field.covers(observation.p_base);
    if (!beside) fresh.push_back(&observation);
  }

  int num_expected = 0, num_seen = 0;
  for (int i = static_cast<int>(num_before) - 1; i >= 0; --i) {
    Entry& entry = entries_[i];
    const bool seen = taken[i];
    const Eigen::Vector2d p_base = inverse_transform(T_local_base_, p_local(i));
    const bool expected = field.covers(p_base) && !occlusion.occludes(p_base);
    num_surprises += expected && is_confirmed(entry) && !seen;
    if (expected && is_confirmed(entry) && entry.num_expected >= kOldScans) {
      ++num_expected;
      num_seen += seen;
    }
    entry.num_expected += seen || expected;
    entry.num_missed_in_a_row = seen ? 0 : entry.num_missed_in_a_row + expected;
    if (entry.num_missed_in_a_row >= kMissedForgotten && !is_confirmed(entry)) remove(i);
  }
  if (num_expected >= kJudgedTrunks) {
    num_inconsistent_scans_ =
        num_seen < kBrokenFraction * num_expected ? num_inconsistent_scans_ + 1 : 0;
  }
  // In an empty map every observation is new, which is no contradiction.
  last_scan_contradicts_ =
      num_before > 0 && num_surprises >= kSurprises && num_surprises > num_matched;

  for (const ScanObservation* observation : fresh) insert(*observation);
  remove_old_trunks();
  const bool looks_anew =
      views_.empty() || travel_m_ - views_.back().travel_m >= kViewTravelM ||
      std::abs(geometry::wrap_angle_rad(T_local_base_.z() - views_.back().T_local_base.z())) >=
          kViewTurnRad;
  if (looks_anew) views_.push_back({T_local_base_, occlusion, travel_m_});
}

bool LocalTrunkMap::is_confirmed(const Entry& entry) const {
  return entry.num_seen >= kConfirmingObservations &&
         entry.num_seen >= kSureFraction * entry.num_expected;
}

int LocalTrunkMap::match(const ScanObservation& observation, const std::vector<bool>& taken,
                         double& nearest_m) const {
  const Eigen::Vector2d p_seen = transform(T_local_base_, observation.p_base);
  const Eigen::Matrix2d R = rotation(T_local_base_.z());
  const Eigen::Matrix2d seen_covariance = R * observation.covariance * R.transpose();
  const Eigen::Vector2d arm = p_seen - T_local_base_.head<2>();
  const Eigen::Matrix<double, 2, 3> J = geometry::point_jacobian(arm);
  int best = -1;
  double best_d2 = kLocalGate2;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const Eigen::Vector2d r = p_seen - x_.segment<2>(3 + 2 * static_cast<Eigen::Index>(i));
    const double distance_m = r.norm();
    nearest_m = std::min(nearest_m, distance_m);
    if (taken[i] || distance_m > kMatchM) continue;
    const auto at = 3 + 2 * static_cast<Eigen::Index>(i);
    const Eigen::Matrix2d cross = J * P_.block<3, 2>(0, at);
    const Eigen::Matrix2d S = J * P_.topLeftCorner<3, 3>() * J.transpose() - cross -
                              cross.transpose() + P_.block<2, 2>(at, at) + seen_covariance;
    const double d2 = r.dot(S.inverse() * r);
    if (d2 < best_d2) {
      best_d2 = d2;
      best = static_cast<int>(i);
    }
  }
  return best;
}

void LocalTrunkMap::correct(int trunk, const ScanObservation& observation) {
  // Innovation: observed minus estimated position, in the local frame.
  const auto at = 3 + 2 * static_cast<Eigen::Index>(trunk);
  const Eigen::Vector2d p_seen = transform(T_local_base_, observation.p_base);
  const Eigen::Vector2d arm = p_seen - T_local_base_.head<2>();
  const Eigen::Matrix<double, 2, 3> J = geometry::point_jacobian(arm);
  const Eigen::Matrix2d R = rotation(T_local_base_.z());
  const Eigen::MatrixXd PHt = P_.leftCols<3>() * J.transpose() - P_.middleCols<2>(at);
  const Eigen::Matrix2d S =
      J * PHt.topRows<3>() - PHt.middleRows<2>(at) + R * observation.covariance * R.transpose();
  const Eigen::MatrixXd K = PHt * S.inverse();
  entries_[trunk].excess_m2 += 0.5 * ((p_seen - x_.segment<2>(at)).squaredNorm() - S.trace());
  x_ -= K * (p_seen - x_.segment<2>(at));
  x_(2) = geometry::wrap_angle_rad(x_(2));
  P_ -= K * PHt.transpose();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  T_local_base_ = x_.head<3>();
  pose_covariance_ = P_.topLeftCorner<3, 3>();

  Entry& entry = entries_[trunk];
  ++entry.num_seen;
  entry.last_travel_m = travel_m_;
  if (observation.width_m > 0.0) {
    const double sd_m = std::max(observation.width_sd_m, config_.width_sd_m);
    entry.width_sum += observation.width_m / (sd_m * sd_m);
    entry.width_weight += 1.0 / (sd_m * sd_m);
    entry.width_sum_m += observation.width_m;
    entry.width_sum_m2 += observation.width_m * observation.width_m;
    entry.width_noise_m2 += sd_m * sd_m;
    ++entry.num_widths;
  }
}

void LocalTrunkMap::insert(const ScanObservation& observation) {
  if (entries_.size() >= kMaxTrunks) remove(longest_unseen());
  const Eigen::Index n = x_.size();
  const Eigen::Vector2d p = transform(T_local_base_, observation.p_base);
  const Eigen::Vector2d arm = p - T_local_base_.head<2>();
  const Eigen::Matrix<double, 2, 3> J = geometry::point_jacobian(arm);
  const Eigen::Matrix2d R = rotation(T_local_base_.z());
  x_.conservativeResize(n + 2);
  x_.tail<2>() = p;
  P_.conservativeResize(n + 2, n + 2);
  const Eigen::MatrixXd rows = J * P_.topLeftCorner(3, n);
  P_.bottomLeftCorner(2, n) = rows;
  P_.topRightCorner(n, 2) = rows.transpose();
  P_.bottomRightCorner<2, 2>() =
      J * pose_covariance_ * J.transpose() + R * observation.covariance * R.transpose();
  Entry entry;
  entry.num_seen = entry.num_expected = 1;
  entry.last_travel_m = travel_m_;
  entries_.push_back(entry);
}

int LocalTrunkMap::longest_unseen() const {
  const auto oldest = std::min_element(
      entries_.begin(), entries_.end(),
      [](const Entry& a, const Entry& b) { return a.last_travel_m < b.last_travel_m; });
  return static_cast<int>(oldest - entries_.begin());
}

void LocalTrunkMap::remove(int trunk) {
  const Eigen::Index at = 3 + 2 * trunk;
  const Eigen::Index n = x_.size();
  const Eigen::Index rest = n - at - 2;
  x_.segment(at, rest) = x_.tail(rest).eval();
  x_.conservativeResize(n - 2);
  P_.middleRows(at, rest) = P_.bottomRows(rest).eval();
  P_.middleCols(at, rest) = P_.rightCols(rest).eval();
  P_.conservativeResize(n - 2, n - 2);
  entries_.erase(entries_.begin() + trunk);
}

void LocalTrunkMap::remove_old_trunks() {
  for (int i = static_cast<int>(entries_.size()) - 1; i >= 0; --i) {
    const Entry& entry = entries_[i];
    const double unseen_m = travel_m_ - entry.last_travel_m;
    if (unseen_m > (is_confirmed(entry) ? config_.window_m : kUnsureTravelM)) remove(i);
  }
  while (!views_.empty() &&
         (travel_m_ - views_.front().travel_m > config_.window_m || views_.size() > kMaxViews)) {
    views_.pop_front();
  }
}

void LocalTrunkMap::reset_origin() {
  const Eigen::Vector3d T = T_local_base_;
  const Eigen::Matrix2d Rt = rotation(T.z()).transpose();
  const Eigen::Index n = x_.size();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index at = 3; at < n; at += 2) {
    const Eigen::Vector2d p = Rt * (x_.segment<2>(at) - T.head<2>());
    x_.segment<2>(at) = p;
    J.block<2, 2>(at, 0) = -Rt;
    J.block<2, 1>(at, 2) = Eigen::Vector2d(p.y(), -p.x());
    J.block<2, 2>(at, at) = Rt;
  }
  P_ = (J * P_ * J.transpose()).eval();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  for (View& view : views_) view.T_local_base = between(T, view.T_local_base);
  T_local_base_.setZero();
  x_.head<3>().setZero();
  pose_covariance_.setZero();
}

std::vector<LocalTrunkMap::Trunk> LocalTrunkMap::trunks(double clump_reach_m) const {
  std::vector<Trunk> trunks;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (!is_confirmed(entry)) continue;
    const auto at = 3 + 2 * static_cast<Eigen::Index>(i);
    Trunk trunk;
    trunk.p_local = x_.segment<2>(at);
    trunk.covariance = P_.block<2, 2>(at, at);
    if (entry.width_weight > 0.0) {
      trunk.width_m = entry.width_sum / entry.width_weight;
      // Scatter of the widths beyond their variance: the object has other widths from other sides.
      const double n = entry.num_widths;
      const double mean_m = entry.width_sum_m / n;
      const double excess_m2 = entry.width_sum_m2 / n - mean_m * mean_m - entry.width_noise_m2 / n;
      trunk.width_sd_m = std::sqrt(1.0 / entry.width_weight + std::max(0.0, excess_m2));
    }
    trunk.last_travel_m = entry.last_travel_m;
    trunk.num_seen = entry.num_seen;
    trunk.num_expected = entry.num_expected;
    trunk.sd_m = std::sqrt(std::max(0.0, entry.excess_m2 / std::max(1, entry.num_seen - 1)));
    trunks.push_back(trunk);
  }
  for (Trunk& trunk : trunks) {
    trunk.num_near =
        static_cast<int>(std::count_if(trunks.begin(), trunks.end(), [&](const Trunk& other) {
          return &other != &trunk && (other.p_local - trunk.p_local).norm() < clump_reach_m;
        }));
  }
  std::stable_sort(trunks.begin(), trunks.end(), [](const Trunk& a, const Trunk& b) {
    return a.last_travel_m > b.last_travel_m;
  });
  return trunks;
}

}  // namespace orchard::pose
