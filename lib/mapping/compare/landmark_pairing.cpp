// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/landmark_pairing.hpp"

#include <algorithm>
#include <cmath>
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

IndexedPoints::IndexedPoints(std::vector<Vector2d> points) : points_(std::move(points)) {
  if (points_.empty()) return;
  corner_ = points_.front();
  Vector2d far = points_.front();
  for (const Vector2d& p : points_) {
    corner_ = corner_.cwiseMin(p);
    far = far.cwiseMax(p);
  }
  // Limit the number of cells, however large the area is.
  const double num_cells_max = 8.0 * static_cast<double>(points_.size()) + 1024.0;
  const auto num_along = [this](double way_m) { return std::floor(way_m * cells_per_m_) + 1.0; };
  const Vector2d way_m = far - corner_;
  while (num_along(way_m.x()) * num_along(way_m.y()) > num_cells_max) cells_per_m_ *= 0.5;
  num_columns_ = static_cast<std::size_t>(num_along(way_m.x()));
  num_lines_ = static_cast<std::size_t>(num_along(way_m.y()));
  const auto cell_of = [this](const Vector2d& p) {
    return line(p.y()) * num_columns_ + column(p.x());
  };
  begins_.assign(num_columns_ * num_lines_ + 1, 0);
  for (const Vector2d& p : points_) ++begins_[cell_of(p) + 1];
  for (std::size_t c = 1; c < begins_.size(); ++c) begins_[c] += begins_[c - 1];
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
  by_cell_.resize(points_.size());
  points_by_cell_.resize(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const std::uint32_t k = next[cell_of(points_[i])]++;
    by_cell_[k] = static_cast<std::int32_t>(i);
    points_by_cell_[k] = points_[i];
  }
}

std::int32_t IndexedPoints::nearest(const Vector2d& p, double radius_m) const {
  std::int32_t best = -1;
  double best_m2 = radius_m * radius_m;
  visit_cells(p, radius_m, [&](std::uint32_t k) {
    const double d_m2 = (points_by_cell_[k] - p).squaredNorm();
    if (d_m2 > best_m2) return;
    const std::int32_t i = by_cell_[k];
    if (d_m2 < best_m2 || best < 0 || i < best) {
      best = i;
      best_m2 = d_m2;
    }
  });
  return best;
}

std::vector<std::int32_t> IndexedPoints::within(const Vector2d& p, double radius_m) const {
  std::vector<std::int32_t> found;
  visit_cells(p, radius_m, [&](std::uint32_t k) {
    if ((points_by_cell_[k] - p).norm() <= radius_m) found.push_back(by_cell_[k]);
  });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::int32_t> IndexedPoints::nearest_few(const Vector2d& p, double radius_m,
                                                     std::size_t count) const {
  std::vector<std::int32_t> found = within(p, radius_m);
  std::stable_sort(found.begin(), found.end(), [&](std::int32_t i, std::int32_t j) {
    return (points_[static_cast<std::size_t>(i)] - p).squaredNorm() <
           (points_[static_cast<std::size_t>(j)] - p).squaredNorm();
  });
  if (found.size() > count) found.resize(count);
  return found;
}

namespace {

struct Offer {
  double distance_m;
  LandmarkPair pair;
};

void offer(const IndexedPoints& a, std::int32_t j, const Vector2d& p_a, double gate_m,
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

std::vector<LandmarkPair> pair_landmarks(const IndexedPoints& a, const IndexedPoints& b,
                                         const geometry::Pose2& T_a_b, double gate_m) {
  std::vector<Offer> offers;
  const Eigen::Matrix2d R_a_b = rotation(T_a_b);
  for (std::size_t j = 0; j < b.size(); ++j) {
    offer(a, static_cast<std::int32_t>(j), R_a_b * b[j] + T_a_b.translation_m(), gate_m, offers);
  }
  return nearest_pairs_of(std::move(offers), a.size(), b.size());
}

std::vector<LandmarkPair> pair_landmarks_near(const IndexedPoints& a, const IndexedPoints& b,
                                              const geometry::Pose2& T_a_b, double gate_m,
                                              const Vector2d& p_a, double radius_m) {
  std::vector<Offer> offers;
  const Eigen::Matrix2d R_a_b = rotation(T_a_b);
  for (const std::int32_t j : b.within(inverse_transform(T_a_b, p_a), radius_m)) {
    offer(a, j, R_a_b * b[static_cast<std::size_t>(j)] + T_a_b.translation_m(), gate_m, offers);
  }
  return nearest_pairs_of(std::move(offers), a.size(), b.size());
}

void remove_common_residuals(const IndexedPoints& a, std::vector<LandmarkPair>& pairs) {
  constexpr std::size_t kNumNeighbours = 10, kFewest = 12;
  constexpr double kReach_m = 25.0;
  if (pairs.size() < kFewest) return;
  std::vector<Vector2d> places;
  for (const LandmarkPair& pair : pairs) places.push_back(a[static_cast<std::size_t>(pair.a)]);
  const IndexedPoints paired(std::move(places));
  std::vector<Vector2d> common(pairs.size(), Vector2d(0.0, 0.0));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    double reach_m = 4.0;
    std::vector<std::int32_t> around;
    while (around.size() <= kNumNeighbours && reach_m <= kReach_m) {
      around = paired.nearest_few(paired[k], reach_m, kNumNeighbours + 1);
      reach_m *= 1.8;
    }
    std::vector<double> x_m, y_m;
    for (const std::int32_t i : around) {
      if (static_cast<std::size_t>(i) == k) continue;
      x_m.push_back(pairs[static_cast<std::size_t>(i)].residual_m.x());
      y_m.push_back(pairs[static_cast<std::size_t>(i)].residual_m.y());
    }
    if (x_m.size() < kNumNeighbours / 2) continue;
    common[k] = {geometry::median(std::move(x_m)), geometry::median(std::move(y_m))};
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k].residual_m -= common[k];
}

double typical_spacing_m(const IndexedPoints& points) {
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (double reach_m = 2.0; reach_m < 200.0; reach_m *= 3.0) {
      const auto near = points.nearest_few(points[i], reach_m, 2);
      if (near.size() < 2) continue;
      const auto other = static_cast<std::size_t>(near[0]) == i ? near[1] : near[0];
      distances_m.push_back((points[static_cast<std::size_t>(other)] - points[i]).norm());
      break;
    }
  }
  return geometry::median(std::move(distances_m));
}

}  // namespace orchard::mapping
