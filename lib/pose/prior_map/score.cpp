// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/score.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "pose/repeat_model.hpp"

namespace orchard::pose {
using geometry::compose;
using geometry::inverse_transform;
using geometry::rotation;

namespace {

constexpr double kScoreGate2 = geometry::kChiSquare2_997;
constexpr double kScoreGate_m = 0.6;

/// Null hypothesis: density of trunks at the position expected by any lattice of rows, about 0.2 m
/// around it [1/m2]. Only a nearer match supports this orchard rather than any orchard.
constexpr double kLatticeDensity = 3.0;

/// Distortion of the local map, standard deviation per root metre.
constexpr double kBendSdM = 0.015;
constexpr double kBendSdRad = 0.003;

/// Approximate min detection rate of objects in a map.
constexpr double kMappedRate = 0.1;

/// Factor on a trunk's probability of being in the map if the earlier drive did not look there; not
/// zero because its coverage is known only approximately.
constexpr double kUnseenFraction = 0.1;

constexpr double kMinWidthEvidence = -2.0;  ///< a trunk may have grown or been measured badly

/// Min number of views with a landmark in sight for it to count as missing.
constexpr int kMissingViews = 3;

}  // namespace

HypothesisScorer::HypothesisScorer(const PriorMap& map, const PriorMapConfig& config,
                                   LocalEvidence evidence)
    : map_(map),
      config_(config),
      evidence_(std::move(evidence)),
      position_variance_(PriorMapConfig::kLandmarkSd_m * PriorMapConfig::kLandmarkSd_m +
                         config.observation_sd_m * config.observation_sd_m),
      gate_radius_m_(std::min(kScoreGate_m, 0.45 * map.spacing_m())) {}

std::optional<PoseHypothesis> HypothesisScorer::fit(const PoseHypothesis& start,
                                                    const std::vector<int>& order,
                                                    double score_min) const {
  PoseHypothesis hypothesis = start;
  Eigen::Vector3d& T = hypothesis.T_map_base;
  Eigen::Matrix3d& P = hypothesis.covariance;
  const Eigen::Vector2d* before = nullptr;
  for (const int k : order) {
    const LocalTrunkMap::Trunk& trunk = evidence_.trunks[static_cast<std::size_t>(k)];
    const Eigen::Vector2d arm = rotation(T.z()) * trunk.p_local;
    if (before) {
      const double apart_m = (trunk.p_local - *before).norm();
      const Eigen::Vector3d turn(arm.y(), -arm.x(), 1.0);  // about the trunk, not the origin
      P += kBendSdRad * kBendSdRad * apart_m * turn * turn.transpose();
      P.topLeftCorner<2, 2>() += kBendSdM * kBendSdM * apart_m * Eigen::Matrix2d::Identity();
    }
    before = &trunk.p_local;

    const Eigen::Vector2d p_map = T.head<2>() + arm;
    Eigen::Matrix<double, 2, 3> J;
    J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    const Eigen::Matrix<double, 3, 2> PJt = P * J.transpose();
    const Eigen::Matrix2d S_all =
        J * PJt + (position_variance_ + trunk.sd_m * trunk.sd_m) * Eigen::Matrix2d::Identity();
    std::int32_t best = -1;
    double best_density = 0.0;
    Eigen::Vector2d best_r = Eigen::Vector2d::Zero();
    Eigen::Matrix2d best_S_inverse = Eigen::Matrix2d::Zero();
    map_.near(p_map, gate_radius_m_, [&](std::int32_t i) {
      const Eigen::Vector2d r = map_[i].p_map - p_map;
      if (r.squaredNorm() > gate_radius_m_ * gate_radius_m_) return;
      const Eigen::Matrix2d S = S_all + map_[i].sd_m * map_[i].sd_m * Eigen::Matrix2d::Identity();
      const Eigen::Matrix2d S_inverse = S.inverse();
      const double d2 = r.dot(S_inverse * r);
      if (d2 > kScoreGate2) return;
      if (std::find(hypothesis.matched.begin(), hypothesis.matched.end(), i) !=
          hypothesis.matched.end())
        return;
      const double density =
          std::exp(-0.5 * d2) * std::sqrt(S_inverse.determinant()) / (2.0 * geometry::kPi);
      if (density <= best_density) return;
      best = i;
      best_density = density;
      best_r = r;
      best_S_inverse = S_inverse;
    });

    // The trunk is the landmark seen again or not in the map; likelihood relative to the lattice.
    double repeated = repeat(trunk);
    if (best < 0 && !map_.was_in_range(p_map)) repeated *= kUnseenFraction;
    const double as_new = 1.0 - repeated;
    double as_landmark = 0.0;
    if (best >= 0) {
      as_landmark =
          repeated * best_density / kLatticeDensity * std::exp(width_evidence(trunk, map_[best]));
    }
    if (as_landmark > as_new) {
      hypothesis.matched.push_back(best);
      const Eigen::Matrix<double, 3, 2> K = PJt * best_S_inverse;
      T += K * best_r;
      P -= K * PJt.transpose();
    } else {
      ++hypothesis.num_new;
    }
    hypothesis.score += std::log(as_new + as_landmark);
    if (hypothesis.score < score_min) return std::nullopt;
  }
  T.z() = geometry::wrap_angle_rad(T.z());
  P = (0.5 * (P + P.transpose())).eval();
  return hypothesis;
}

double HypothesisScorer::repeat(const LocalTrunkMap::Trunk& trunk) const {
  return (1.0 - kChangeFraction) * probability_same_part(trunk.num_near) *
         probability_seen_again(detection_rate(trunk.num_seen, trunk.num_expected), kMappedRate);
}

void HypothesisScorer::count_missing(PoseHypothesis& hypothesis) const {
  const double range_m = evidence_.field.range_m();
  std::vector<std::int32_t> nearby;
  for (const LocalTrunkMap::View& view : evidence_.views) {
    const Eigen::Vector3d T = compose(hypothesis.T_map_base, view.T_local_base);
    map_.near(T.head<2>(), range_m, [&](std::int32_t i) {
      const Eigen::Vector2d p_base = inverse_transform(T, map_[i].p_map);
      if (evidence_.field.covers(p_base) && !view.occlusion.occludes(p_base)) nearby.push_back(i);
    });
  }
  std::sort(nearby.begin(), nearby.end());
  for (std::size_t begin = 0, end = 0; begin < nearby.size(); begin = end) {
    while (end < nearby.size() && nearby[end] == nearby[begin]) ++end;
    const bool matched = std::find(hypothesis.matched.begin(), hypothesis.matched.end(),
                                   nearby[begin]) != hypothesis.matched.end();
    if (matched || end - begin < kMissingViews || stands_near(hypothesis, nearby[begin])) continue;
    ++hypothesis.num_missing;
    hypothesis.score += std::log(1.0 - map_.repeat(nearby[begin]));
  }
}

bool HypothesisScorer::stands_near(const PoseHypothesis& hypothesis, std::int32_t landmark) const {
  const Eigen::Vector2d p = inverse_transform(hypothesis.T_map_base, map_[landmark].p_map);
  return std::any_of(evidence_.trunks.begin(), evidence_.trunks.end(), [&](const auto& trunk) {
    return (trunk.p_local - p).norm() < map_.clump_reach_m();
  });
}

double HypothesisScorer::width_evidence(const LocalTrunkMap::Trunk& trunk,
                                        const PriorLandmark& landmark) const {
  const double population2 = map_.width_sd_m() * map_.width_sd_m();
  if (trunk.width_m <= 0.0 || landmark.width_m <= 0.0 || population2 <= 0.0) return 0.0;
  const double same2 =
      trunk.width_sd_m * trunk.width_sd_m + config_.width_sd_m * config_.width_sd_m;
  const double other2 = same2 + 2.0 * population2;
  const double apart_m = trunk.width_m - landmark.width_m;
  return std::max(kMinWidthEvidence, 0.5 * std::log(other2 / same2) -
                                         0.5 * apart_m * apart_m * (1.0 / same2 - 1.0 / other2));
}

std::vector<int> HypothesisScorer::order_from(const Eigen::Vector2d& p_local) const {
  std::vector<int> order(evidence_.trunks.size());
  std::iota(order.begin(), order.end(), 0);
  const auto distance2 = [&](int i) {
    return (evidence_.trunks[static_cast<std::size_t>(i)].p_local - p_local).squaredNorm();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return distance2(a) < distance2(b); });
  return order;
}

}  // namespace orchard::pose
