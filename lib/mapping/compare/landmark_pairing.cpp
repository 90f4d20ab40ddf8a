// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/landmark_pairing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "geometry/statistics.hpp"

namespace orchard::mapping {

using Eigen::Vector2d;

std::vector<Vector2d> landmark_positions(const std::vector<Landmark>& landmarks) {
  std::vector<Vector2d> places;
  places.reserve(landmarks.size());
  for (const Landmark& l : landmarks) places.push_back({l.x_m, l.y_m});
  return places;
}

namespace {

struct Offer {
  double distance_m;
  LandmarkPair pair;
};

void offer(const geometry::IndexedPoints& a, std::int32_t j, const Vector2d& p_a, double gate_m,
           std::vector<Offer>& offers) {
  for (const std::int32_t i : a.within(p_a, gate_m)) {
    const Vector2d residual_m = p_a - a[static_cast<std::size_t>(i)];
    offers.push_back({residual_m.norm(), {i, j, residual_m}});
  }
}

std::vector<LandmarkPair> nearest_pairs_of(std::vector<Offer> offers, std::size_t num_a,
                                           std::size_t num_b) {
  std::sort(offers.begin(), offers.end(), [](const Offer& x, const Offer& y) {
    return std::tie(x.distance_m, x.pair.a, x.pair.b) < std::tie(y.distance_m, y.pair.a, y.pair.b);
  });
  std::vector<bool> taken_a(num_a, false), taken_b(num_b, false);
  std::vector<LandmarkPair> pairs;
  for (const Offer& o : offers) {
    const auto i = static_cast<std::size_t>(o.pair.a);
    const auto j = static_cast<std::size_t>(o.pair.b);
    if (taken_a[i] || taken_b[j]) continue;
    taken_a[i] = taken_b[j] = true;
    pairs.push_back(o.pair);
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const LandmarkPair& x, const LandmarkPair& y) { return x.a < y.a; });
  return pairs;
}

}  // namespace

std::vector<LandmarkPair> pairs_in(const std::vector<LandmarkPair>& pairs,
                                   const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                                   const std::vector<Landmark>& other_a,
                                   const std::vector<Landmark>& other_b) {
  const auto places_of = [](const std::vector<Landmark>& landmarks) {
    std::map<std::int32_t, std::int32_t> place_of_id;
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      place_of_id[landmarks[i].id] = static_cast<std::int32_t>(i);
    }
    return place_of_id;
  };
  const auto in_a = places_of(other_a), in_b = places_of(other_b);
  std::vector<LandmarkPair> found;
  for (const LandmarkPair& pair : pairs) {
    const auto of_a = in_a.find(a[static_cast<std::size_t>(pair.a)].id);
    const auto of_b = in_b.find(b[static_cast<std::size_t>(pair.b)].id);
    if (of_a == in_a.end() || of_b == in_b.end()) continue;
    found.push_back({of_a->second, of_b->second, pair.residual_m});
  }
  return found;
}

double told_rms_m(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                  const std::vector<LandmarkPair>& pairs) {
  double sum_m2 = 0.0;
  for (const LandmarkPair& pair : pairs) {
    for (const Landmark* l :
         {&a[static_cast<std::size_t>(pair.a)], &b[static_cast<std::size_t>(pair.b)]}) {
      sum_m2 += l->se_x_m * l->se_x_m + l->se_y_m * l->se_y_m;
    }
  }
  return std::sqrt(sum_m2 / static_cast<double>(std::max<std::size_t>(1, pairs.size())));
}

std::vector<LandmarkPair> pair_landmarks(const geometry::IndexedPoints& a,
                                         const geometry::IndexedPoints& b,
                                         const geometry::Pose2& T_a_b, double gate_m) {
  std::vector<Offer> offers;
  const Eigen::Matrix2d R_a_b = rotation(T_a_b);
  for (std::size_t j = 0; j < b.size(); ++j) {
    offer(a, static_cast<std::int32_t>(j), R_a_b * b[j] + T_a_b.translation_m(), gate_m, offers);
  }
  return nearest_pairs_of(std::move(offers), a.size(), b.size());
}

std::vector<LandmarkPair> pair_landmarks_near(const geometry::IndexedPoints& a,
                                              const geometry::IndexedPoints& b,
                                              const geometry::Pose2& T_a_b, double gate_m,
                                              const Vector2d& p_a, double radius_m) {
  std::vector<Offer> offers;
  const Eigen::Matrix2d R_a_b = rotation(T_a_b);
  for (const std::int32_t j : b.within(inverse_transform(T_a_b, p_a), radius_m)) {
    offer(a, j, R_a_b * b[static_cast<std::size_t>(j)] + T_a_b.translation_m(), gate_m, offers);
  }
  return nearest_pairs_of(std::move(offers), a.size(), b.size());
}

namespace {

// derived: ten residuals give a median with a standard error of 0.4 of theirs; a slow deformation
// is the same over the trees of a few rows.
constexpr std::size_t kNumAround = 10, kPairsMin = 12;
constexpr double kAroundMax_m = 25.0;

geometry::IndexedPoints paired_places(const geometry::IndexedPoints& a,
                                      const std::vector<LandmarkPair>& pairs) {
  std::vector<Vector2d> places;
  for (const LandmarkPair& pair : pairs) places.push_back(a[static_cast<std::size_t>(pair.a)]);
  return geometry::IndexedPoints(std::move(places));
}

/// Median residual of the pairs nearest to a position, without that of the pair `left_out`; none
/// for fewer than half of kNumAround. `places`: paired_places().
std::optional<Vector2d> residual_around(const geometry::IndexedPoints& places,
                                        const std::vector<LandmarkPair>& pairs, const Vector2d& p_a,
                                        std::int32_t left_out) {
  std::vector<std::int32_t> near;
  for (double reach_m = 4.0; near.size() <= kNumAround && reach_m <= kAroundMax_m; reach_m *= 1.8) {
    near = places.nearest_few(p_a, reach_m, kNumAround + 1);
  }
  std::vector<double> x_m, y_m;
  for (const std::int32_t k : near) {
    if (k == left_out) continue;
    x_m.push_back(pairs[static_cast<std::size_t>(k)].residual_m.x());
    y_m.push_back(pairs[static_cast<std::size_t>(k)].residual_m.y());
  }
  if (x_m.size() < kNumAround / 2) return std::nullopt;
  return Vector2d(geometry::median(std::move(x_m)), geometry::median(std::move(y_m)));
}

}  // namespace

double pairing_gate_m(const geometry::IndexedPoints& places) {
  return std::clamp(0.35 * geometry::typical_spacing_m(places), 0.1, 0.5);
}

void remove_common_residuals(const geometry::IndexedPoints& a, std::vector<LandmarkPair>& pairs) {
  if (pairs.size() < kPairsMin) return;
  const geometry::IndexedPoints places = paired_places(a, pairs);
  std::vector<Vector2d> common;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    common.push_back(residual_around(places, pairs, places[k], static_cast<std::int32_t>(k))
                         .value_or(Vector2d(0.0, 0.0)));
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k].residual_m -= common[k];
}

std::vector<Vector2d> without_local_deformation(const geometry::IndexedPoints& a,
                                                const geometry::IndexedPoints& b,
                                                const geometry::Pose2& T_a_b,
                                                const std::vector<LandmarkPair>& pairs) {
  std::vector<Vector2d> places;
  for (const Vector2d& p : b.points()) places.push_back(transform(T_a_b, p));
  if (pairs.size() < kPairsMin) return places;
  const geometry::IndexedPoints around = paired_places(a, pairs);
  std::vector<std::int32_t> own(places.size(), -1);  // none is corrected by its own residual
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    own[static_cast<std::size_t>(pairs[k].b)] = static_cast<std::int32_t>(k);
  }
  for (std::size_t j = 0; j < places.size(); ++j) {
    const auto common = residual_around(around, pairs, places[j], own[j]);
    if (common) places[j] -= *common;
  }
  return places;
}

}  // namespace orchard::mapping
