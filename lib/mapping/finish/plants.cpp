// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/plants.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// Landmarks with their places.
struct PlacedLandmarks {
  explicit PlacedLandmarks(std::vector<Landmark> all)
      : landmarks(std::move(all)), places(landmark_positions(landmarks)) {}

  std::vector<Landmark> landmarks;
  geometry::IndexedPoints places;
};

/// A landmark that stands for a plant, by index.
struct Plant {
  std::size_t stem = 0;             ///< its most often seen tree; without one, its most seen part
  std::vector<std::int32_t> parts;  ///< ids of all its landmarks
  std::vector<std::int32_t> alike;  ///< ids of those of the stem's class
};

/// A hedge or wall: its position is that of its middle, beside which anything may stand.
bool is_long(const Landmark& l) { return l.length_m > 0.0; }

/// The plants of a map, when their parts lie within `reach_m` of their stem.
std::vector<Plant> plants_of(const PlacedLandmarks& all, double reach_m) {
  const std::vector<Landmark>& l = all.landmarks;
  const auto rank = [&](std::size_t i) {
    return std::tuple(l[i].label != detection::Label::kTree, -l[i].num_observations, l[i].id);
  };
  std::vector<std::size_t> order(l.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  std::vector<char> is_part(l.size(), 0);
  std::vector<Plant> plants;
  for (const std::size_t i : order) {
    if (is_part[i]) continue;
    Plant& plant = plants.emplace_back(Plant{i, {}, {}});
    if (is_long(l[i])) continue;
    for (const std::int32_t near : all.places.within(all.places[i], reach_m)) {
      const auto k = static_cast<std::size_t>(near);
      if (is_part[k] || is_long(l[k])) continue;
      is_part[k] = 1;
      plant.parts.push_back(l[k].id);
      if (l[k].label == l[i].label) plant.alike.push_back(l[k].id);
    }
  }
  return plants;
}

/// Each plant as one landmark: its stem, at the common place of those of its class.
std::vector<Landmark> joined(const PlacedLandmarks& all, const std::vector<Plant>& plants,
                             const CommonPlace& place) {
  std::vector<Landmark> ones;
  ones.reserve(plants.size());
  for (const Plant& plant : plants) {
    const Landmark& stem = all.landmarks[plant.stem];
    ones.push_back(plant.alike.size() < 2 ? stem : place(stem, plant.alike));
  }
  std::sort(ones.begin(), ones.end(),
            [](const Landmark& a, const Landmark& b) { return a.id < b.id; });
  return ones;
}

/// The place of the stem alone.
Landmark of_stem(const Landmark& stem, const std::vector<std::int32_t>&) { return stem; }

/// Median distance from a landmark to the nearest other one [m]; 0 without any within
/// `reach_max_m`.
double nearest_distance_m(const PlacedLandmarks& all, double reach_max_m) {
  std::vector<double> distances_m;
  for (const Eigen::Vector2d& p : all.places.points()) {
    const auto near = all.places.nearest_few(p, reach_max_m, 2);
    if (near.size() < 2) continue;
    distances_m.push_back((all.places[static_cast<std::size_t>(near[1])] - p).norm());
  }
  return geometry::median(std::move(distances_m));
}

/// Median spacing of all slots of the rows [m]; 0 without rows.
double spacing_of_m(const std::vector<Row>& rows) {
  std::vector<double> spacings_m;
  for (const Row& row : rows) spacings_m.insert(spacings_m.end(), row.places.size(), row.spacing_m);
  return geometry::median(std::move(spacings_m));
}

std::size_t num_trees(const std::vector<Row>& rows) {
  std::size_t num = 0;
  for (const Row& row : rows) {
    for (const RowSlot& slot : row.places) num += slot.landmark_id != 0 ? 1u : 0u;
  }
  return num;
}

/// derived: plants of a row are not farther apart than this [m], the widest spacing of fruit trees.
constexpr double kSpacingMax_m = 15.0;

std::size_t num_labelled_trees(const std::vector<Landmark>& landmarks) {
  return static_cast<std::size_t>(
      std::count_if(landmarks.begin(), landmarks.end(),
                    [](const Landmark& l) { return l.label == detection::Label::kTree; }));
}

/// derived: what is thinned out keeps its distance, so up to a quarter of it stands in rows by
/// chance.
constexpr std::size_t kPlantsPerTreeInRow = 3;

/// derived: a reach that has not come back to itself after so many rounds swings between spacings.
constexpr int kReachRounds = 10;

/// First guess of the reach of a plant [m]: a third of the spacing of the rows, which appear when
/// the parts are thinned out step by step: those with most trees. 0 without rows.
double guessed_reach_m(const PlacedLandmarks& all, const RowsConfig& config) {
  double reach_m = 0.0;
  std::size_t most = 0;
  for (double thinned_m = 0.0; thinned_m < tuning::kOnePlace_spacings * kSpacingMax_m;) {
    const PlacedLandmarks thin(joined(all, plants_of(all, thinned_m), of_stem));
    const std::vector<Row> rows = find_rows(thin.landmarks, config);
    const std::size_t num = num_trees(rows);
    if (num > most) {
      most = num;
      reach_m = tuning::kOnePlace_spacings * spacing_of_m(rows);
    }
    const double nearest_m = nearest_distance_m(thin, kSpacingMax_m);
    if (nearest_m <= thinned_m) break;
    thinned_m = nearest_m;
  }
  return reach_m;
}

/// Reach of a plant [m]: a third of the spacing of the rows of the plants so joined. A first guess
/// may have counted shoots midway between stems as trees. The larger one where two give each
/// other; 0 where the trees in rows are few of the plants.
double reach_of_plants_m(const PlacedLandmarks& all, const RowsConfig& config) {
  double reach_m = guessed_reach_m(all, config), last_m = 0.0;
  for (int round = 0; round < kReachRounds && reach_m != last_m; ++round) {
    const std::vector<Landmark> plants = joined(all, plants_of(all, reach_m), of_stem);
    const std::vector<Row> rows = find_rows(plants, config);
    if (kPlantsPerTreeInRow * num_trees(rows) <= num_labelled_trees(plants)) return 0.0;
    last_m = std::exchange(reach_m, tuning::kOnePlace_spacings * spacing_of_m(rows));
  }
  return std::max(reach_m, last_m);
}

/// True if most of what stands beside the stems of the plants in rows is part of them. Parts are
/// trees as often as any landmark is, other things beside trunks, as weeds, never: so it is where
/// the share of trees is more than half that of all landmarks.
bool are_parts(const PlacedLandmarks& all, const std::vector<Plant>& plants,
               const RowsConfig& config) {
  std::set<std::int32_t> in_rows;
  for (const Row& row : find_rows(joined(all, plants, of_stem), config)) {
    for (const RowSlot& slot : row.places) in_rows.insert(slot.landmark_id);
  }
  std::map<std::int32_t, bool> is_tree;
  for (const Landmark& l : all.landmarks) is_tree[l.id] = l.label == detection::Label::kTree;
  std::size_t num = 0, num_of_trees = 0;
  for (const Plant& plant : plants) {
    const std::int32_t stem = all.landmarks[plant.stem].id;
    if (in_rows.count(stem) == 0) continue;
    for (const std::int32_t id : plant.parts) {
      num += id != stem ? 1u : 0u;
      num_of_trees += id != stem && is_tree[id] ? 1u : 0u;
    }
  }
  return 2 * num_of_trees * all.landmarks.size() > num * num_labelled_trees(all.landmarks);
}

}  // namespace

std::vector<Landmark> join_plants(std::vector<Landmark> landmarks, const RowsConfig& config,
                                  const CommonPlace& place) {
  if (landmarks.empty()) return landmarks;
  const PlacedLandmarks all(std::move(landmarks));
  const double reach_m = reach_of_plants_m(all, config);
  if (reach_m <= 0.0) return all.landmarks;
  const std::vector<Plant> plants = plants_of(all, reach_m);
  if (!are_parts(all, plants, config)) return all.landmarks;
  // Plants whose common places turn out to be one place are one plant.
  const PlacedLandmarks placed(joined(all, plants, place));
  return joined(placed, plants_of(placed, reach_m), of_stem);
}

}  // namespace orchard::mapping
