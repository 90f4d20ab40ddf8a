// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::geometry {
namespace {

/// Table position of a cell. Four cells of a column share a cache line; the line's index is hashed
/// from all bits of the key, so that the regular rows of an orchard do not cluster in one part of
/// the table.
std::uint64_t spread(std::uint64_t key) {
  std::uint64_t h = (key >> 2) * 0x9E3779B97F4A7C15ull;
  h ^= h >> 32;
  h *= 0xD6E8FEB86659FD93ull;
  h ^= h >> 32;
  return (h << 2) | (key & 3);
}

}  // namespace

std::size_t PointGrid::find(std::uint64_t wanted) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = static_cast<std::size_t>(spread(wanted)) & mask;
  while (slots_[at].head != kEmpty && slots_[at].key != wanted) at = (at + 1) & mask;
  return at;
}

void PointGrid::grow() {
  std::vector<Slot> old = std::exchange(slots_, {});
  slots_.resize(old.empty() ? 64 : old.size() * 2);
  num_used_ = 0;
  for (const Slot& slot : old) {
    if (slot.head < 0) continue;
    slots_[find(slot.key)] = slot;
    ++num_used_;
  }
}

void PointGrid::insert(std::int32_t index, double x_m, double y_m) {
  if (slots_.empty() || 10 * (num_used_ + 1) > 7 * slots_.size()) grow();
  const std::size_t i = static_cast<std::size_t>(index);
  if (next_.size() <= i) next_.resize(i + 1, kNone);
  Slot& slot = slots_[find(key(cell(x_m), cell(y_m)))];
  if (slot.head == kEmpty) {
    slot.key = key(cell(x_m), cell(y_m));
    slot.head = kNone;
    ++num_used_;
  }
  next_[i] = slot.head;
  slot.head = index;
}

void PointGrid::remove(std::int32_t index, double x_m, double y_m) {
  if (slots_.empty()) return;
  std::int32_t* link = &slots_[find(key(cell(x_m), cell(y_m)))].head;
  while (*link >= 0 && *link != index) link = &next_[static_cast<std::size_t>(*link)];
  if (*link == index) *link = next_[static_cast<std::size_t>(index)];
}

void PointGrid::move(std::int32_t index, double from_x_m, double from_y_m, double to_x_m,
                     double to_y_m) {
  if (cell(from_x_m) == cell(to_x_m) && cell(from_y_m) == cell(to_y_m)) return;
  remove(index, from_x_m, from_y_m);
  insert(index, to_x_m, to_y_m);
}

void PointGrid::clear() {
  slots_.clear();
  next_.clear();
  num_used_ = 0;
}

std::vector<std::int32_t> PointGrid::near(const Eigen::Vector2d& p, double radius_m) const {
  std::vector<std::int32_t> found;
  const auto visit = [&](std::int32_t i) { found.push_back(i); };
  const std::int32_t x_first = cell(p.x() - radius_m), x_last = cell(p.x() + radius_m);
  const std::int32_t y_first = cell(p.y() - radius_m), y_last = cell(p.y() + radius_m);
  const double num_cells = (1.0 + x_last - x_first) * (1.0 + y_last - y_first);
  if (num_cells <= static_cast<double>(slots_.size())) {
    near(p.x(), p.y(), radius_m, visit);
  } else {  // most cells are empty: walk those that are not
    for (const Slot& slot : slots_) {
      if (slot.head < 0) continue;
      const auto cx = static_cast<std::int32_t>(static_cast<std::uint32_t>(slot.key >> 32));
      const auto cy = static_cast<std::int32_t>(static_cast<std::uint32_t>(slot.key));
      if (cx < x_first || cx > x_last || cy < y_first || cy > y_last) continue;
      for (std::int32_t i = slot.head; i >= 0; i = next_[static_cast<std::size_t>(i)]) visit(i);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

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
