// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/plan/plan_fit.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"
#include "mapping/compare/alignment_candidates.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;
using geometry::Pose2;

/// derived: odds of a thousand to one with four trees counted as one, because neighbouring trees
/// deviate from the plan together.
constexpr double kPlacementOddsNeeded = 4.0 * 7.0;
/// derived: budgets of directions, of shifts of each, and of placements that are refined.
constexpr std::size_t kNumTurns = 6;
constexpr std::size_t kNumShifts = 40;
constexpr std::size_t kNumPlacementsMax = 12;

constexpr double kPositionSdMin_m = 0.03;

class PlanFitter {
 public:
  PlanFitter(const geometry::IndexedPoints& mapped, const geometry::IndexedPoints& planned,
             const MissProbability& missed, const MapAlignmentConfig& config)
      : mapped_(mapped), planned_(planned), missed_(missed), config_(config) {
    spacing_m_ = geometry::typical_spacing_m(planned);
    noise_.gate_m = std::clamp(0.35 * spacing_m_, 0.1, 1.0);
    search_.any_place = config.any_place;
    search_.offset_max_m = config.offset_max_m;
    search_.turn_max_rad = config.turn_max_deg * geometry::kPi / 180.0;
    search_.gate_m = noise_.gate_m;
    for (const Vector2d& p : planned.points()) {
      middle_plan_ += p / static_cast<double>(planned.size());
    }
  }

  PlanFit fit() {
    std::vector<PlanPlacement> placements;
    for (const Pose2& T : turns()) {
      for (PlanPlacement& p : shifts_of(T)) add_distinct(std::move(p), placements);
    }
    return judge(std::move(placements));
  }

 private:
  /// Density of planned trees, from the number of neighbours of each.
  double density() const {
    constexpr double kReachOfSpacings = 6.0;
    const double reach_m = std::max(1.0, kReachOfSpacings * spacing_m_);
    std::vector<double> counts;
    const std::size_t step = std::max<std::size_t>(1, planned_.size() / 200);
    for (std::size_t i = 0; i < planned_.size(); i += step) {
      counts.push_back(static_cast<double>(planned_.within(planned_[i], reach_m).size()));
    }
    return std::max(1.0, geometry::median(std::move(counts))) / (geometry::kPi * reach_m * reach_m);
  }

  bool is_within_limits(const Pose2& T) const {
    return config_.any_place ||
           ((transform(T, middle_plan_) - middle_plan_).norm() <= config_.offset_max_m &&
            std::abs(geometry::wrap_angle_rad(T.yaw_rad)) <= search_.turn_max_rad + 1e-3);
  }

  /// One placement per direction, those with most pairs.
  std::vector<Pose2> turns() const {
    constexpr double kOneTurn_rad = 0.03;
    const std::vector<double> alike_a(mapped_.size(), 0.1), alike_b(planned_.size(), 0.1);
    const AlignmentCandidates found =
        alignment_candidates(mapped_, alike_a, planned_, alike_b, search_);
    std::vector<Pose2> turns;
    for (const AlignmentCandidate& c : found.candidates) {
      const bool is_known = std::any_of(turns.begin(), turns.end(), [&](const Pose2& T) {
        return std::abs(geometry::wrap_angle_rad(T.yaw_rad - c.T_a_b.yaw_rad)) < kOneTurn_rad;
      });
      if (!is_known && turns.size() < kNumTurns) turns.push_back(refined(c.T_a_b).T_map_plan);
    }
    // Many orchards are symmetric under a rotation by half a circle.
    if (config_.any_place) {
      for (std::size_t k = 0, num = turns.size(); k < num; ++k) {
        const Pose2 turned{0.0, 0.0, geometry::wrap_angle_rad(turns[k].yaw_rad + geometry::kPi)};
        const bool is_known = std::any_of(turns.begin(), turns.end(), [&](const Pose2& T) {
          return std::abs(geometry::wrap_angle_rad(T.yaw_rad - turned.yaw_rad)) < kOneTurn_rad;
        });
        if (!is_known) turns.push_back(turned);
      }
    }
    return turns;
  }

  /// Placements in the direction of `turn`, for every shift that puts many planned positions onto
  /// trees.
  std::vector<PlanPlacement> shifts_of(const Pose2& turn) const {
    constexpr std::size_t kNumAnchors = 80;  // derived: a budget
    std::vector<std::size_t> order(mapped_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
      return std::make_tuple(mapped_[i].x(), mapped_[i].y(), i) <
             std::make_tuple(mapped_[j].x(), mapped_[j].y(), j);
    });
    const std::size_t num_anchors = std::min(kNumAnchors, order.size());
    const double cell_m = noise_.gate_m / 1.5;
    std::vector<std::uint64_t> cells;
    for (std::size_t k = 0; k < num_anchors; ++k) {
      const Vector2d& p = mapped_[order[(2 * k + 1) * order.size() / (2 * num_anchors)]];
      for (const Vector2d& q : planned_.points()) {
        const Vector2d shift = p - geometry::rotation(turn) * q;
        if (!is_within_limits({shift.x(), shift.y(), turn.yaw_rad})) continue;
        cells.push_back(key_of(std::llround(shift.x() / cell_m), std::llround(shift.y() / cell_m)));
      }
    }
    std::sort(cells.begin(), cells.end());
    std::vector<std::pair<std::uint64_t, int>> counts;
    for (const std::uint64_t cell : cells) {
      if (counts.empty() || counts.back().first != cell) counts.push_back({cell, 0});
      ++counts.back().second;
    }
    const auto count_at = [&](std::uint64_t cell) {
      const auto at = std::lower_bound(counts.begin(), counts.end(), std::make_pair(cell, 0));
      return at != counts.end() && at->first == cell ? at->second : 0;
    };
    std::vector<std::pair<int, std::uint64_t>> votes;
    for (const auto& [cell, count] : counts) {
      int sum = 0, most_around = 0;
      const auto [x, y] = place_of(cell);
      for (int dx = -1; dx <= 1; ++dx) {
        for (int dy = -1; dy <= 1; ++dy) {
          const int there = count_at(key_of(x + dx, y + dy));
          sum += there;
          if (dx != 0 || dy != 0) most_around = std::max(most_around, there);
        }
      }
      if (count >= most_around) votes.push_back({-sum, cell});
    }
    std::sort(votes.begin(), votes.end());
    std::vector<PlanPlacement> placements;
    for (const auto& [negative, cell] : votes) {
      if (placements.size() >= kNumShifts || 3 * negative > votes.front().first) break;
      const auto [x, y] = place_of(cell);
      PlanPlacement placement =
          refined({static_cast<double>(x) * cell_m, static_cast<double>(y) * cell_m, turn.yaw_rad});
      if (is_within_limits(placement.T_map_plan)) placements.push_back(std::move(placement));
    }
    return placements;
  }

  static std::uint64_t key_of(std::int64_t x, std::int64_t y) {
    const auto half = [](std::int64_t v) {
      return static_cast<std::uint64_t>(std::clamp<std::int64_t>(v + (1LL << 31), 0, 0xffffffffLL));
    };
    return (half(x) << 32) | half(y);
  }
  static std::pair<std::int64_t, std::int64_t> place_of(std::uint64_t key) {
    return {static_cast<std::int64_t>(key >> 32) - (1LL << 31),
            static_cast<std::int64_t>(key & 0xffffffffULL) - (1LL << 31)};
  }

  /// Iteratively reweighted least squares over the pairs.
  PlanPlacement refined(const Pose2& begin) const {
    constexpr int kNumRounds = 6;
    PlanPlacement placement;
    placement.T_map_plan = begin;
    for (int round = 0; round < kNumRounds; ++round) {
      placement.pairs = pair_landmarks(mapped_, planned_, placement.T_map_plan, noise_.gate_m);
      if (placement.pairs.size() < 2) return placement;
      std::vector<Vector2d> a, b;
      std::vector<double> apart_m, weights;
      for (const LandmarkPair& pair : placement.pairs) {
        a.push_back(mapped_[static_cast<std::size_t>(pair.a)]);
        b.push_back(planned_[static_cast<std::size_t>(pair.b)]);
        apart_m.push_back(pair.residual_m.norm());
      }
      const double scale_m = std::max(kPositionSdMin_m, geometry::median(apart_m));
      for (const double m : apart_m) weights.push_back(1.0 / (1.0 + m * m / (scale_m * scale_m)));
      placement.T_map_plan = geometry::fit_rigid(a, b, weights).T_a_b;
    }
    placement.pairs = pair_landmarks(mapped_, planned_, placement.T_map_plan, noise_.gate_m);
    return placement;
  }

  double apart_m(const Pose2& T, const Pose2& other) const {
    return (transform(T, middle_plan_) - transform(other, middle_plan_)).norm();
  }

  void add_distinct(PlanPlacement placement, std::vector<PlanPlacement>& placements) const {
    constexpr double kOneTurn_rad = 0.03;
    for (PlanPlacement& known : placements) {
      if (apart_m(known.T_map_plan, placement.T_map_plan) > 0.5 * spacing_m_ ||
          std::abs(geometry::wrap_angle_rad(known.T_map_plan.yaw_rad -
                                            placement.T_map_plan.yaw_rad)) > kOneTurn_rad) {
        continue;
      }
      if (placement.pairs.size() > known.pairs.size()) known = std::move(placement);
      return;
    }
    placements.push_back(std::move(placement));
  }

  double position_sd_m(const PlanPlacement& placement) const {
    std::vector<double> deviations_m;
    for (const LandmarkPair& pair : placement.pairs) {
      deviations_m.push_back(pair.residual_m.x());
      deviations_m.push_back(pair.residual_m.y());
    }
    return std::max(kPositionSdMin_m, geometry::robust_sd(std::move(deviations_m)));
  }

  /// Expected number of planned positions at which the drive would have seen a tree.
  double num_places_seen(const PlanPlacement& placement) const {
    double num = 0.0;
    for (const Vector2d& p : planned_.points()) {
      num += 1.0 - missed_(transform(placement.T_map_plan, p));
    }
    return num;
  }

  /// Noise of a placement when `num_extra` of the mapped trees are not planned.
  PlanNoise noise_of(const PlanPlacement& placement, std::size_t num_extra,
                     double num_places_seen) const {
    PlanNoise noise = noise_;
    noise.position_sd_m = position_sd_m(placement);
    noise.extra_per_m2 = density() * std::max(kRare, static_cast<double>(num_extra) /
                                                         std::max(1.0, num_places_seen));
    return noise;
  }

  /// Whether a placement explains the mapped trees better than no plan, by which all are extra:
  /// trees as dense as bushes are near many places by chance, but not near nearly all.
  bool is_no_chance(const PlanPlacement& placement, double num_places_seen) const {
    const PlanNoise noise = noise_of(placement, mapped_.size(), num_places_seen);
    return plan_log_likelihood(planned_, placement.T_map_plan, placement.pairs, noise, missed_) >
           kPlacementOddsNeeded;
  }

  PlanFit judge(std::vector<PlanPlacement> placements) {
    PlanFit fit;
    std::stable_sort(placements.begin(), placements.end(),
                     [](const PlanPlacement& p, const PlanPlacement& q) {
                       return p.pairs.size() > q.pairs.size();
                     });
    const std::size_t num_most = placements.empty() ? 0 : placements.front().pairs.size();
    const double num_seen = placements.empty() ? 0.0 : num_places_seen(placements.front());
    if (num_most < static_cast<std::size_t>(std::max(2, config_.min_pairs)) ||
        !is_no_chance(placements.front(), num_seen)) {
      fit.reason = fmt::format(
          "at most {} of the {:.0f} places of the plan that the drive saw have a tree{}", num_most,
          num_seen,
          config_.any_place ? std::string(" in any placement")
                            : fmt::format(" within {:.1f} m and {:.0f} degrees",
                                          config_.offset_max_m, config_.turn_max_deg));
      return fit;
    }
    fit.noise = noise_ = noise_of(placements.front(), mapped_.size() - num_most, num_seen);
    std::vector<double> log_likelihood;
    std::size_t best = 0;
    for (std::size_t k = 0; k < placements.size(); ++k) {
      const PlanPlacement& p = placements[k];
      log_likelihood.push_back(
          plan_log_likelihood(planned_, p.T_map_plan, p.pairs, noise_, missed_));
      if (log_likelihood[k] > log_likelihood[best]) best = k;
    }
    std::vector<std::pair<double, std::size_t>> rivals;
    for (std::size_t k = 0; k < placements.size(); ++k) {
      if (k == best) continue;
      placements[k].log_odds = log_likelihood[best] - log_likelihood[k];
      if (placements[k].log_odds <= kPlacementOddsNeeded)
        rivals.push_back({placements[k].log_odds, k});
    }
    std::sort(rivals.begin(), rivals.end());
    fit.status = rivals.empty() ? AlignmentStatus::kAligned : AlignmentStatus::kAmbiguous;
    fit.placements.push_back(placements[best]);
    for (const auto& [log_odds, k] : rivals) {
      if (fit.placements.size() < kNumPlacementsMax) fit.placements.push_back(placements[k]);
    }
    if (!rivals.empty()) {
      const PlanPlacement& rival = placements[rivals.front().second];
      const double turn_rad = std::abs(
          geometry::wrap_angle_rad(rival.T_map_plan.yaw_rad - placements[best].T_map_plan.yaw_rad));
      fit.reason = fmt::format(
          "{} placements of the plan fit about equally well; the most similar one is {:.1f} m "
          "away{}",
          rivals.size() + 1, apart_m(placements[best].T_map_plan, rival.T_map_plan),
          turn_rad > 0.1
              ? fmt::format(", rotated by {:.0f} degrees", turn_rad * 180 / geometry::kPi)
              : std::string());
    }
    return fit;
  }

  const geometry::IndexedPoints& mapped_;
  const geometry::IndexedPoints& planned_;
  const MissProbability& missed_;
  const MapAlignmentConfig& config_;
  AlignmentSearch search_;
  PlanNoise noise_;
  double spacing_m_ = 0.0;
  Vector2d middle_plan_{0.0, 0.0};
};

}  // namespace

PlanFit fit_plan(const geometry::IndexedPoints& mapped, const geometry::IndexedPoints& planned,
                 const MissProbability& missed, const MapAlignmentConfig& config) {
  if (mapped.size() < 2 || planned.size() < 2) {
    PlanFit fit;
    fit.reason = "at least two trees are needed to register a map to a plan";
    return fit;
  }
  return PlanFitter(mapped, planned, missed, config).fit();
}

}  // namespace orchard::mapping
