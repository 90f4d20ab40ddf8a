// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/landmark_splitting.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: Maximum number of scans examined per landmark, the newest.
constexpr std::size_t kScansMax = 100;

/// An observation near a landmark, in map; associated with it or not.
struct WindowObservation {
  std::int32_t observation = 0;
  std::int32_t scan = 0;
  Vector2d p_map;
};
using Window = std::vector<WindowObservation>;

/// Positions of two objects, the more often observed one first.
struct PositionPair {
  Vector2d first, second;
};

/// Observations within `reach_m` of a point in the newest scans of a landmark's chain, with the
/// given poses, in order of scan; including those of other landmarks.
Window observations_around(const ObservationStore& observations, std::int32_t head,
                           const Vector2d& p_map, double reach_m) {
  std::vector<std::int32_t> scans;
  for (const std::int32_t k : observations.newest_of(head, kScansMax)) {
    scans.push_back(observations[k].scan);
  }
  std::sort(scans.begin(), scans.end());
  scans.erase(std::unique(scans.begin(), scans.end()), scans.end());
  Window window;
  for (const std::int32_t scan : scans) {
    for (std::int32_t k = observations.first_of(scan); k < observations.first_of(scan + 1); ++k) {
      const Vector2d p = observations.p_map(k);
      if ((p - p_map).squaredNorm() < reach_m * reach_m) window.push_back({k, scan, p});
    }
  }
  return window;
}

/// Per scan of the window, in order: whether an observation lies within `reach_m` of the position.
std::vector<char> scans_showing(const Window& window, const Vector2d& position, double reach_m) {
  std::vector<char> shown;
  for (std::size_t i = 0; i < window.size(); ++i) {
    if (i == 0 || window[i].scan != window[i - 1].scan) shown.push_back(0);
    if ((window[i].p_map - position).squaredNorm() < reach_m * reach_m) shown.back() = 1;
  }
  return shown;
}

int count(const std::vector<char>& shown) {
  return static_cast<int>(std::count(shown.begin(), shown.end(), 1));
}

/// Whether scans repeatedly occupy both positions at the same time, with little between them. A
/// wrong pose shows one object at two positions, but never in the same scan.
bool are_distinct(const Window& window, const Vector2d& a, const Vector2d& b,
                  const std::vector<char>& at_a, const std::vector<char>& at_b) {
  int both = 0;
  for (std::size_t i = 0; i < at_a.size(); ++i) both += at_a[i] & at_b[i];
  const int fewer = std::min(count(at_a), count(at_b));
  if (both < tuning::kAtOnceMin || both < tuning::kAtOnceFraction * fewer) return false;
  return count(scans_showing(window, 0.5 * (a + b), tuning::kBetween_m)) <=
         tuning::kBetweenFractionMax * fewer;
}

/// Mean of the observations at the position occupied in the most scans, among positions that
/// satisfy `is_allowed`.
template <class IsAllowed>
std::optional<Vector2d> best_position(const Window& window, const IsAllowed& is_allowed) {
  int num_best = 0;
  Vector2d best;
  for (const WindowObservation& o : window) {
    if (!is_allowed(o.p_map)) continue;
    const int num = count(scans_showing(window, o.p_map, tuning::kAtPosition_m));
    if (num <= num_best) continue;
    num_best = num;
    best = o.p_map;
  }
  if (num_best == 0) return std::nullopt;
  Vector2d sum = Vector2d::Zero();
  int num = 0;
  for (const WindowObservation& o : window) {
    if ((o.p_map - best).squaredNorm() >= tuning::kAtPosition_m * tuning::kAtPosition_m) continue;
    sum += o.p_map;
    ++num;
  }
  return sum / num;
}

/// Positions of two objects, more than `apart_m` apart, whose observations are in one landmark;
/// none for a single object.
std::optional<PositionPair> two_positions(const Window& window, double apart_m) {
  const auto first = best_position(window, [](const Vector2d&) { return true; });
  if (!first) return std::nullopt;
  const auto second = best_position(
      window, [&](const Vector2d& p) { return (p - *first).squaredNorm() > apart_m * apart_m; });
  if (!second || (*second - *first).norm() <= apart_m) return std::nullopt;
  const auto at_first = scans_showing(window, *first, tuning::kAtPosition_m);
  const auto at_second = scans_showing(window, *second, tuning::kAtPosition_m);
  const int num = count(at_second);
  if (num < tuning::kRarerScansMin || num < tuning::kRarerFraction * count(at_first))
    return std::nullopt;
  if (!are_distinct(window, *first, *second, at_first, at_second)) return std::nullopt;
  return PositionPair{*first, *second};
}

/// Whether a landmark with `num_observations` observations is examined now: often at first, rarely
/// later, so that the cost per observation is constant.
bool is_review_due(std::int32_t num_observations) {
  if (num_observations < 16) return false;
  if (num_observations <= 128) return num_observations % 8 == 0;
  return (num_observations & (num_observations - 1)) == 0;
}

/// Whether another landmark already exists at one of the positions.
bool is_known(const MapState& map, std::int32_t index, const PositionPair& positions) {
  const double reach_m = 0.5 * map.config.split_distance_m;
  bool known = false;
  for (const Vector2d& position : {positions.first, positions.second}) {
    map.landmarks.near(position, reach_m, [&](std::int32_t i, const LandmarkRecord& other) {
      const double distance_m = (other.association_position() - position).norm();
      known = known || (i != index && distance_m < reach_m);
    });
  }
  return known;
}

/// Assigns each observation of the landmark to the nearer position. A scan with one associated
/// observation and a secondary return at the other position has observed both. Returns false,
/// without any change, if one half would have too few observations.
bool split(MapState& map, std::int32_t index, const Window& window, const PositionPair& positions) {
  const ObservationStore& observations = map.observations;
  const auto is_nearer_second = [&](const Vector2d& p) {
    return (p - positions.second).squaredNorm() < (p - positions.first).squaredNorm();
  };
  constexpr auto kAll = std::numeric_limits<std::size_t>::max();  // derived: no limit
  std::array<std::vector<std::int32_t>, 2> chains;
  std::array<std::set<std::int32_t>, 2> scans;
  for (const std::int32_t k : observations.newest_of(map.landmarks[index].last_observation, kAll)) {
    const int to = is_nearer_second(observations.p_map(k)) ? 1 : 0;
    chains[to].push_back(k);
    scans[to].insert(observations[k].scan);
  }
  for (const WindowObservation& o : window) {
    const int to = is_nearer_second(o.p_map) ? 1 : 0;
    const double away_m = (o.p_map - (to == 1 ? positions.second : positions.first)).norm();
    if (observations[o.observation].is_associated || away_m > 0.5 * map.config.split_distance_m)
      continue;
    if (scans[to].insert(o.scan).second) chains[to].push_back(o.observation);
  }
  if (std::min(chains[0].size(), chains[1].size()) < tuning::kHalfObservationsMin) return false;
  const LandmarkRecord was = map.landmarks[index];
  map.rebuild_landmark(index, was, std::move(chains[0]));
  map.rebuild_landmark(map.landmarks.add(positions.second, was.width_m), was, std::move(chains[1]));
  return true;
}

}  // namespace

void split_landmarks(MapState& map, MapUpdate& update) {
  const MapperConfig& config = map.config;
  if (!config.split_landmarks || 2.0 * config.gate_m <= config.split_distance_m) return;
  const std::size_t num_changed = update.changed_ids.size();
  for (std::size_t k = 0; k < num_changed; ++k) {
    const std::int32_t index = update.changed_ids[k] - 1;
    const LandmarkRecord& r = map.landmarks[index];
    if (r.is_removed || r.is_clump || !is_review_due(r.num_all)) continue;
    const Window window = observations_around(map.observations, r.last_observation,
                                              r.association_position(), config.gate_m);
    const auto positions = two_positions(window, config.split_distance_m);
    if (!positions || is_known(map, index, *positions)) continue;
    if (!split(map, index, window, *positions)) continue;
    update.changed_ids.push_back(map.landmarks.num_indices());
  }
}

bool are_distinct_landmarks(const MapState& map, std::int32_t a, std::int32_t b) {
  if (!map.config.split_landmarks) return false;
  const LandmarkRecord& r = map.landmarks[a];
  const LandmarkRecord& other = map.landmarks[b];
  const LandmarkRecord& fewer = r.num_all < other.num_all ? r : other;
  const Vector2d p_a = r.association_position(), p_b = other.association_position();
  const Window window = observations_around(map.observations, fewer.last_observation,
                                            fewer.association_position(), 2.0 * map.config.merge_m);
  return are_distinct(window, p_a, p_b, scans_showing(window, p_a, tuning::kAtPosition_m),
                      scans_showing(window, p_b, tuning::kAtPosition_m));
}

}  // namespace orchard::mapping
