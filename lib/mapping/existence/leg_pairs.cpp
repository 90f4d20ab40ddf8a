// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/leg_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/existence/legs.hpp"

namespace orchard::mapping {
namespace {

/// Landmarks with less than this fraction of a neighbour's observations are clutter beside it: a
/// part of it or a twig.
constexpr double kStray = 0.1;
/// Minimum fraction of the unoccluded scans that show the other leg.
constexpr double kBeside = 0.5;
/// Longest time that a person stands still [us].
constexpr std::int64_t kStandsMax_us = 120'000'000;
/// Max number of observations examined for how long it stood, and for the other leg.
constexpr std::size_t kObservationsMax = 2000, kBesideObservationsMax = 64;
/// Pairs are legs only if rows have more than this many trees per paired tree; else they are double
/// stems.
constexpr double kTreesPerPair = 10.0;

Eigen::Vector2d place_of(const Landmark& l) { return {l.x_m, l.y_m}; }

bool is_leg_wide(const Landmark& l) { return l.width_m >= kLegMin_m && l.width_m <= kLegMax_m; }

/// Offset of the other leg from a landmark: most scans that show the landmark, and see past it,
/// show a second object as thin as a leg at one position beside it. Uses the scans, not the
/// landmarks, because the second of two so close objects is often stored as a secondary return of
/// the first, or removed before it.
std::optional<Eigen::Vector2d> other_leg(const MapState& map, const Landmark& leg) {
  const ObservationStore& all = map.observations;
  const double nearest_m = std::max(kStanceMin_m, leg.width_m);  // two objects do not overlap
  const auto seen =
      all.newest_of(map.landmarks[leg.id - 1].last_observation, kBesideObservationsMax);
  std::vector<std::optional<Eigen::Vector2d>> beside(seen.size());
  std::vector<double> x_m, y_m, widths_m, all_widths_m(seen.size(), 0.0);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::int32_t k = seen[i];
    const Eigen::Vector2d p_map = all.p_map(k);
    std::int32_t nearest = -1;
    double found_m = kStanceMax_m;
    for (std::int32_t c = all.first_of(all[k].scan); c < all.first_of(all[k].scan + 1); ++c) {
      const double apart_m = (all.p_map(c) - p_map).norm();
      if (c == k || apart_m < nearest_m || apart_m >= found_m) continue;
      nearest = c;
      found_m = apart_m;
    }
    if (nearest < 0) continue;
    beside[i] = all.p_map(nearest) - p_map;
    x_m.push_back(beside[i]->x());
    y_m.push_back(beside[i]->y());
    widths_m.push_back(all[nearest].width_m);
    all_widths_m[i] = all[nearest].width_m;
  }
  if (x_m.empty()) return std::nullopt;
  const double width_m = geometry::median(widths_m);
  const Eigen::Vector2d other(geometry::median(x_m), geometry::median(y_m));
  int num_clear = 0, num_shown = 0;
  std::vector<double> clear_widths_m;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const pose::PoseEstimate& from = all.pose(all[seen[i]].scan);
    const Eigen::Vector2d view =
        (all.p_map(seen[i]) - Eigen::Vector2d(from.x_m, from.y_m)).normalized();
    const double across_m = std::abs(view.x() * other.y() - view.y() * other.x());
    const bool is_clear = across_m > 0.5 * (leg.width_m + width_m);
    const bool is_shown = beside[i] && (*beside[i] - other).norm() < kStanceMin_m;
    num_clear += is_clear;
    num_shown += is_shown;
    if (is_clear && is_shown) clear_widths_m.push_back(all_widths_m[i]);
  }
  if (static_cast<double>(clear_widths_m.size()) <= kBeside * num_clear ||
      num_shown < kStray * static_cast<double>(seen.size())) {
    return std::nullopt;
  }
  const double clear_m = geometry::median(std::move(clear_widths_m));
  const bool is_leg = clear_m >= kLegMin_m && clear_m <= kLegMax_m;
  return is_leg ? std::make_optional(other) : std::nullopt;
}

/// Whether a landmark was observed for no longer than a person stands still, be it in one visit of
/// the robot or in several.
bool only_briefly(const MapState& map, std::int32_t id) {
  const std::vector<std::int32_t> newest =
      map.observations.newest_of(map.landmarks[id - 1].last_observation, kObservationsMax);
  if (newest.empty() || newest.size() == kObservationsMax) return false;
  const auto utime_of = [&](std::int32_t k) {
    return map.observations.pose(map.observations[k].scan).utime;
  };
  return utime_of(newest.front()) - utime_of(newest.back()) <= kStandsMax_us;
}

class StanceNeighbours {
 public:
  explicit StanceNeighbours(const std::vector<Landmark>& landmarks) : landmarks_(landmarks) {
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      grid_.insert(static_cast<std::int32_t>(i), landmarks[i].x_m, landmarks[i].y_m);
    }
  }

  /// Indices of the others within kStanceMax_m, in ascending order.
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

/// Landmarks that stand as a leg does: as thin, with another leg beside them and no third object.
class LegTest {
 public:
  LegTest(const MapState& map, const std::vector<Landmark>& landmarks)
      : map_(map), landmarks_(landmarks), neighbours_(landmarks) {}

  int num_of(const Landmark& l) const { return map_.landmarks[l.id - 1].num_all; }
  std::vector<std::size_t> beside(std::size_t i) const { return neighbours_.of(i); }

  bool operator()(std::size_t i) const {
    const Landmark& a = landmarks_[i];
    if (!is_leg_wide(a)) return false;
    const auto other = other_leg(map_, a);
    if (!other) return false;
    const auto others = beside(i);
    return std::none_of(others.begin(), others.end(), [&](std::size_t k) {
      const Landmark& c = landmarks_[k];
      const double beside_m = (place_of(c) - place_of(a) - *other).norm();
      return beside_m >= kStanceMin_m && num_of(c) >= kStray * num_of(a);
    });
  }

 private:
  const MapState& map_;
  const std::vector<Landmark>& landmarks_;
  StanceNeighbours neighbours_;
};

/// Whether the trees in the rows of this map stand singly, not in pairs.
bool trees_stand_alone(const LegTest& stands_as_leg, const std::vector<Landmark>& landmarks) {
  int num_trees = 0, num_paired = 0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i].row == 0) continue;
    ++num_trees;
    num_paired += stands_as_leg(i);
  }
  return num_trees > kTreesPerPair * (num_paired + 1);
}

}  // namespace

std::vector<std::int32_t> leg_pairs(const MapState& map, const std::vector<Landmark>& landmarks,
                                    bool trusts_camera) {
  std::vector<std::int32_t> legs;
  const LegTest stands_as_leg(map, landmarks);
  if (!trees_stand_alone(stands_as_leg, landmarks)) return legs;
  const auto stays = [&](const Landmark& l) {
    const bool is_sure = trusts_camera && l.label == detection::Label::kTree;
    return l.row > 0 || l.length_m > 0.0 || is_sure;
  };
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& a = landmarks[i];
    if (stays(a) || !only_briefly(map, a.id) || !stands_as_leg(i)) continue;
    const auto others = stands_as_leg.beside(i);
    // The landmark with more observations decides.
    if (std::any_of(others.begin(), others.end(), [&](std::size_t k) {
          return stays(landmarks[k]) ||
                 stands_as_leg.num_of(landmarks[k]) > stands_as_leg.num_of(a);
        })) {
      continue;
    }
    legs.push_back(a.id);
    for (const std::size_t k : others) legs.push_back(landmarks[k].id);
  }
  std::sort(legs.begin(), legs.end());
  legs.erase(std::unique(legs.begin(), legs.end()), legs.end());
  return legs;
}

}  // namespace orchard::mapping
