// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/leg_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/point_grid.hpp"

namespace orchard::mapping {
namespace {

/// Legs at the height of knees and calves are 0.10 to 0.14 m thick (a girth of 0.33 to 0.43 m);
/// trousers and what a scanner errs make them this wide at most, and half hidden ones narrower [m].
constexpr double kLegMin_m = 0.08, kLegMax_m = 0.22;
/// The middles of the two legs of a standing person [m].
constexpr double kStanceMin_m = 0.10, kStanceMax_m = 0.45;
/// What was seen less than a tenth as often as a thing is stray beside it: a part of it, a twig.
constexpr double kStray = 0.1;
/// A robot that has seen nothing of a place for longer comes back there [us].
constexpr std::int64_t kVisitGap_us = 20'000'000;
/// Nobody stands still for longer [us].
constexpr std::int64_t kStandsMax_us = 120'000'000;
/// Observations that are enough to know when a thing was seen.
constexpr std::size_t kVisitObservationsMax = 2000;
/// Where one of so many trees of rows, or more, is one of a pair, pairs are stems.
constexpr double kTreesPerPair = 10.0;

Eigen::Vector2d place_of(const Landmark& l) { return {l.x_m, l.y_m}; }

bool is_leg_wide(const Landmark& l) { return l.width_m >= kLegMin_m && l.width_m <= kLegMax_m; }

bool are_as_legs(const Landmark& a, const Landmark& b) {
  const double apart_m = (place_of(a) - place_of(b)).norm();
  return apart_m >= kStanceMin_m && apart_m <= kStanceMax_m &&
         std::max(a.width_m, b.width_m) <= kLegMax_m && (is_leg_wide(a) || is_leg_wide(b));
}

struct Visit {
  std::int64_t first_us = 0, last_us = 0;
};

/// When a landmark was seen, if that was once and not for long.
std::optional<Visit> only_visit(const MapState& map, std::int32_t id) {
  const std::vector<std::int32_t> newest =
      map.observations.newest_of(map.landmarks[id - 1].last_observation, kVisitObservationsMax);
  if (newest.empty() || newest.size() == kVisitObservationsMax) return std::nullopt;
  const auto utime_of = [&](std::int32_t k) {
    return map.observations.pose(map.observations[k].scan).utime;
  };
  Visit seen{utime_of(newest.front()), utime_of(newest.front())};
  for (const std::int32_t k : newest) {
    const std::int64_t utime = utime_of(k);
    if (seen.first_us - utime > kVisitGap_us) return std::nullopt;
    seen.first_us = std::min(seen.first_us, utime);
    seen.last_us = std::max(seen.last_us, utime);
  }
  if (seen.last_us - seen.first_us > kStandsMax_us) return std::nullopt;
  return seen;
}

class StanceNeighbours {
 public:
  explicit StanceNeighbours(const std::vector<Landmark>& landmarks) : landmarks_(landmarks) {
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      grid_.insert(static_cast<std::int32_t>(i), landmarks[i].x_m, landmarks[i].y_m);
    }
  }

  /// Indices of the others within kStanceMax_m, in rising order.
  std::vector<std::size_t> of(std::size_t i) const {
    std::vector<std::size_t> others;
    grid_.near(landmarks_[i].x_m, landmarks_[i].y_m, kStanceMax_m, [&](std::int32_t k) {
      const auto other = static_cast<std::size_t>(k);
      const double apart_m = (place_of(landmarks_[i]) - place_of(landmarks_[other])).norm();
      if (other != i && apart_m <= kStanceMax_m) others.push_back(other);
    });
    std::sort(others.begin(), others.end());
    return others;
  }

 private:
  const std::vector<Landmark>& landmarks_;
  geometry::PointGrid grid_{2.0};
};

/// Whether trees of rows stand alone, by the rows of this map.
bool trees_stand_alone(const std::vector<Landmark>& landmarks, const StanceNeighbours& neighbours) {
  int num_trees = 0, num_paired = 0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& tree = landmarks[i];
    if (tree.row == 0) continue;
    const auto others = neighbours.of(i);
    ++num_trees;
    num_paired += std::any_of(others.begin(), others.end(), [&](std::size_t k) {
      return are_as_legs(tree, landmarks[k]) &&
             landmarks[k].num_observations >= kStray * tree.num_observations;
    });
  }
  return num_trees > kTreesPerPair * (num_paired + 1);
}

}  // namespace

std::vector<std::int32_t> leg_pairs(const MapState& map, const std::vector<Landmark>& landmarks,
                                    bool camera_tells) {
  const StanceNeighbours neighbours(landmarks);
  std::vector<std::int32_t> legs;
  if (!trees_stand_alone(landmarks, neighbours)) return legs;
  const auto stays = [&](const Landmark& l) {
    const bool is_sure = camera_tells && l.label == detection::Label::kTree;
    return l.row > 0 || l.length_m > 0.0 || is_sure;
  };
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& a = landmarks[i];
    const auto others = neighbours.of(i);
    for (const std::size_t k : others) {
      const Landmark& b = landmarks[k];
      // the one that was seen more often tells
      if (b.num_observations > a.num_observations ||
          (b.num_observations == a.num_observations && k < i)) {
        continue;
      }
      if (stays(a) || stays(b) || !are_as_legs(a, b)) continue;
      if (b.num_observations < kStray * a.num_observations) continue;
      const bool has_third = std::any_of(others.begin(), others.end(), [&](std::size_t c) {
        return c != k && (stays(landmarks[c]) ||
                          landmarks[c].num_observations >= kStray * a.num_observations);
      });
      const auto seen_a = only_visit(map, a.id), seen_b = only_visit(map, b.id);
      if (has_third || !seen_a || !seen_b) continue;
      if (seen_a->first_us > seen_b->last_us || seen_b->first_us > seen_a->last_us) continue;
      legs.push_back(a.id);
      for (const std::size_t c : others) legs.push_back(landmarks[c].id);
    }
  }
  std::sort(legs.begin(), legs.end());
  legs.erase(std::unique(legs.begin(), legs.end()), legs.end());
  return legs;
}

}  // namespace orchard::mapping
