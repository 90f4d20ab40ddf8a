// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/indexed_points.hpp"

#include <cmath>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::geometry {

using Eigen::Vector2d;

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
  return median(std::move(distances_m));
}

}  // namespace orchard::geometry
