// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "geometry/pose2.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"
#include "pose/repeat_model.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

using geometry::compose;
using geometry::inverse_transform;
using geometry::rotation;
namespace {

// derived: quantile of the gate, and less than the distance of two trunks [m].
constexpr double kScoreGate2 = geometry::kChiSquare2_997;
constexpr double kScoreGate_m = 0.6;

// physical: objects that are detected less often are in no map; a trunk may have grown.
constexpr double kMappedRate = 0.1;
constexpr double kMinWidthEvidence = -2.0;

// derived: a landmark counts as missing if three views show its place; a shorter pair determines
// the heading poorly; the numbers of pairs bound the cost of a search, three for each trunk so that
// no single one spoils it.
constexpr int kMissingViews = 3;
constexpr double kPairMinM = 1.5;
constexpr std::size_t kSeedTrunks = 14;
constexpr std::size_t kMaxSeeds = 10;
constexpr int kSeedsPerTrunk = 3;
constexpr double kToleranceSigma = 3.0;

// derived: poses nearer to each other than this are the same. Hypotheses with a score below
// kGivenUpScore are abandoned: by Ville's inequality the likelihood ratio of the true pose falls
// below e^-12 at some trunk in one of 160,000 searches. Those far below the best are negligible.
constexpr double kSamePlaceM = 0.5;
constexpr double kSamePlaceRad = 0.2;
constexpr double kGivenUpScore = -12.0;
constexpr double kKeptBelowBest = 30.0;
constexpr std::size_t kMaxPlaces = 200;

bool is_same_pose(const PoseHypothesis& a, const PoseHypothesis& b) {
  return (a.T_map_base - b.T_map_base).head<2>().norm() < kSamePlaceM &&
         std::abs(geometry::wrap_angle_rad(a.T_map_base.z() - b.T_map_base.z())) < kSamePlaceRad;
}

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
    const LocalTrunkMap::Trunk& trunk = evidence_.trunks[k];
    const Eigen::Vector2d arm = rotation(T.z()) * trunk.p_local;
    if (before) {
      const double apart_m = (trunk.p_local - *before).norm();
      const Eigen::Vector3d turn(arm.y(), -arm.x(), 1.0);  // about the trunk, not the origin
      P += kLocalBendSd_rad * kLocalBendSd_rad * apart_m * turn * turn.transpose();
      P.topLeftCorner<2, 2>() +=
          kLocalBendSd_m * kLocalBendSd_m * apart_m * Eigen::Matrix2d::Identity();
    }
    before = &trunk.p_local;

    const Eigen::Vector2d p_map = T.head<2>() + arm;
    const Eigen::Matrix<double, 2, 3> J = geometry::point_jacobian(arm);
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
    if (best < 0 && !map_.was_seen(p_map)) repeated *= kUnseenFraction;
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
    return (evidence_.trunks[i].p_local - p_local).squaredNorm();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return distance2(a) < distance2(b); });
  return order;
}

PriorMapSearch::PriorMapSearch(const PriorMap& map, const PriorMapConfig& config,
                               LocalEvidence evidence)
    : map_(map), config_(config), scorer_(map, config, std::move(evidence)) {
  choose_seeds();
  if (!seeds_.empty()) next_pair_ = seeds_.front().begin;
}

void PriorMapSearch::choose_seeds() {
  const auto& trunks = scorer_.evidence().trunks;
  const double pair_sd_m =
      std::sqrt(2.0) * std::hypot(PriorMapConfig::kLandmarkSd_m, config_.observation_sd_m);
  std::vector<Seed> candidates;
  const int num = static_cast<int>(std::min(trunks.size(), kSeedTrunks));
  for (int i = 0; i < num; ++i) {
    for (int j = i + 1; j < num; ++j) {
      const double apart_m = (trunks[i].p_local - trunks[j].p_local).norm();
      if (apart_m < kPairMinM || apart_m > kHypothesisPairMax_m) continue;
      Seed seed;
      seed.first = i;
      seed.second = j;
      std::tie(seed.begin, seed.end) = map_.pairs_at(apart_m - kToleranceSigma * pair_sd_m,
                                                     apart_m + kToleranceSigma * pair_sd_m);
      if (seed.begin < seed.end) candidates.push_back(std::move(seed));
    }
  }
  // The rarest distances first. Each trunk is used in few seeds, so that a new trunk, which is in
  // no pair of the map, cannot spoil all of them.
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Seed& a, const Seed& b) { return a.end - a.begin < b.end - b.begin; });
  std::vector<int> uses(trunks.size(), 0);
  for (Seed& seed : candidates) {
    int& first = uses[seed.first];
    int& second = uses[seed.second];
    if (first >= kSeedsPerTrunk || second >= kSeedsPerTrunk) continue;
    ++first;
    ++second;
    const Eigen::Vector2d middle = 0.5 * (trunks[seed.first].p_local + trunks[seed.second].p_local);
    for (const int k : scorer_.order_from(middle)) {
      if (k != seed.first && k != seed.second) seed.order.push_back(k);
    }
    seeds_.push_back(std::move(seed));
    if (seeds_.size() >= kMaxSeeds) break;
  }
}

bool PriorMapSearch::step(int num_hypotheses) {
  for (int tried = 0; tried < num_hypotheses && seed_ < seeds_.size();) {
    const Seed& seed = seeds_[seed_];
    if (next_pair_ >= seed.end) {
      if (++seed_ < seeds_.size()) next_pair_ = seeds_[seed_].begin;
      continue;
    }
    const PriorMap::Pair& pair = map_.pairs()[next_pair_++];
    try_hypothesis(seed, pair.first, pair.second);
    try_hypothesis(seed, pair.second, pair.first);
    tried += 2;
  }
  return seed_ >= seeds_.size();
}

void PriorMapSearch::try_hypothesis(const Seed& seed, std::int32_t first, std::int32_t second) {
  const auto& a = scorer_.evidence().trunks[seed.first];
  const auto& b = scorer_.evidence().trunks[seed.second];
  const Eigen::Vector2d from_local = b.p_local - a.p_local;
  const Eigen::Vector2d from_map = map_[second].p_map - map_[first].p_map;
  const double length_m = from_local.norm();
  const double end_variance = PriorMapConfig::kLandmarkSd_m * PriorMapConfig::kLandmarkSd_m +
                              config_.observation_sd_m * config_.observation_sd_m;

  PoseHypothesis start;
  const geometry::Pose2 T_map_local =
      geometry::pose_from_two_pairs(map_[first].p_map, map_[second].p_map, a.p_local, b.p_local);
  const Eigen::Vector2d arm = rotation(T_map_local) * (0.5 * (a.p_local + b.p_local));
  start.T_map_base = T_map_local.vector();
  const double yaw_variance = 2.0 * end_variance / (length_m * length_m);
  const Eigen::Vector3d turn(arm.y(), -arm.x(), 1.0);  // rotation about the middle of the pair
  start.covariance = yaw_variance * turn * turn.transpose();
  start.covariance.topLeftCorner<2, 2>() += 0.5 * end_variance * Eigen::Matrix2d::Identity();
  // The pair's positions determine the pose, so only its length and the widths add to the score.
  const double stretch_m = from_map.norm() - length_m;
  start.score = -0.25 * stretch_m * stretch_m / end_variance +
                scorer_.width_evidence(a, map_[first]) + scorer_.width_evidence(b, map_[second]);
  start.matched = {first, second};

  std::optional<PoseHypothesis> hypothesis = scorer_.fit(start, seed.order, kGivenUpScore);
  if (!hypothesis) return;
  const double best = hypotheses_.empty() ? -kKeptBelowBest : hypotheses_.front().score;
  if (hypothesis->score < best - kKeptBelowBest) return;
  scorer_.count_missing(*hypothesis);
  keep(*std::move(hypothesis));
}

void PriorMapSearch::keep(PoseHypothesis hypothesis) {
  for (auto other = hypotheses_.begin(); other != hypotheses_.end();) {
    if (!is_same_pose(*other, hypothesis)) {
      ++other;
      continue;
    }
    if (other->score >= hypothesis.score) return;
    other = hypotheses_.erase(other);
  }
  const auto at = std::upper_bound(
      hypotheses_.begin(), hypotheses_.end(), hypothesis,
      [](const PoseHypothesis& a, const PoseHypothesis& b) { return a.score > b.score; });
  hypotheses_.insert(at, std::move(hypothesis));
  while (hypotheses_.size() > kMaxPlaces ||
         hypotheses_.back().score < hypotheses_.front().score - kKeptBelowBest) {
    hypotheses_.pop_back();
  }
}

SearchResult PriorMapSearch::result() const {
  SearchResult result;
  result.hypotheses = hypotheses_;
  if (hypotheses_.empty()) return result;
  // Abandoned hypotheses count with the score at which they were abandoned.
  double rivals = std::exp(kGivenUpScore - hypotheses_.front().score);
  for (std::size_t i = 1; i < hypotheses_.size(); ++i) {
    rivals += std::exp(hypotheses_[i].score - hypotheses_.front().score);
  }
  result.log_odds = std::min(kKeptBelowBest, -std::log(rivals));
  // In a large map anything fits somewhere, but then it fits elsewhere about as well: include the
  // lead over the other poses.
  const double score = hypotheses_.front().score;
  result.log_fit = score + result.log_odds - kScoreAndLeadElsewhere;

  // Refit from the oldest trunk to the newest: the local map is distorted, and base is at its end.
  std::vector<int> order(scorer_.evidence().trunks.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = static_cast<int>(order.size() - 1 - i);
  }
  PoseHypothesis start;
  start.T_map_base = hypotheses_.front().T_map_base;
  start.covariance = Eigen::Vector3d(0.2 * 0.2, 0.2 * 0.2, 0.03 * 0.03).asDiagonal();
  if (const std::optional<PoseHypothesis> hypothesis = scorer_.fit(start, order)) {
    if (is_same_pose(*hypothesis, hypotheses_.front())) {
      result.hypotheses.front().T_map_base = hypothesis->T_map_base;
      result.hypotheses.front().covariance = hypothesis->covariance;
    }
  }
  return result;
}

}  // namespace orchard::pose
