// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/point_map.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::pose {

namespace {

/// Extent of the local map beyond the scanner's max range [m].
constexpr double kMapRadius_m = 50.0;

/// Min distance between two points of the map [m], above the noise of a range.
constexpr double kMapSpacing_m = 0.07;

/// Max number of points per cell; bounds the cost of a query.
constexpr int kMapCellPointsMax = 16;

/// Side of a cell of the map [m], about the max pair distance of the last iterations.
constexpr double kMapCell_m = 0.4;

}  // namespace

PointMap::PointMap(const ScanMotionConfig& config)
    : cell_m_(kMapCell_m),
      spacing2_m2_(kMapSpacing_m * kMapSpacing_m),
      cell_points_max_(static_cast<std::size_t>(kMapCellPointsMax)) {
  const double cells = 2.0 * (kMapRadius_m + config.range_max_m) / cell_m_;
  while ((1 << bits_) < cells && bits_ < 14) ++bits_;
  mask_ = (1 << bits_) - 1;
  cells_.resize(std::size_t{1} << (2 * bits_));
}

void PointMap::clear() {
  for (Cell& cell : cells_) cell.entries.clear();
  empty_ = true;
}

std::int32_t PointMap::index(double coordinate_m) const {
  return static_cast<std::int32_t>(std::floor(coordinate_m / cell_m_));
}

void PointMap::insert(const SurfacePoint& point, double travel_m) {
  const std::int32_t ix = index(point.p.x());
  const std::int32_t iy = index(point.p.y());
  Cell& cell = cells_[slot(ix, iy)];
  if (cell.ix != ix || cell.iy != iy) {
    cell.ix = ix;
    cell.iy = iy;
    cell.entries.clear();
  }
  for (Entry& entry : cell.entries) {
    if (entry.seen_m >= oldest_m_ && (entry.point.p - point.p).squaredNorm() < spacing2_m2_) {
      entry.seen_m = travel_m;
      return;
    }
  }
  if (cell.entries.size() >= cell_points_max_) {
    const auto is_old = [this](const Entry& entry) { return entry.seen_m < oldest_m_; };
    cell.entries.erase(std::remove_if(cell.entries.begin(), cell.entries.end(), is_old),
                       cell.entries.end());
    if (cell.entries.size() >= cell_points_max_) return;
  }
  cell.entries.push_back({point, travel_m});
  empty_ = false;
}

const SurfacePoint* PointMap::nearest(const Eigen::Vector2d& p_map, double radius_m,
                                      double& distance2_m2) const {
  const std::int32_t x0 = index(p_map.x() - radius_m), x1 = index(p_map.x() + radius_m);
  const std::int32_t y0 = index(p_map.y() - radius_m), y1 = index(p_map.y() + radius_m);
  const SurfacePoint* best = nullptr;
  double best2 = radius_m * radius_m;
  for (std::int32_t ix = x0; ix <= x1; ++ix) {
    for (std::int32_t iy = y0; iy <= y1; ++iy) {
      const Cell& cell = cells_[slot(ix, iy)];
      if (cell.ix != ix || cell.iy != iy) continue;
      for (const Entry& entry : cell.entries) {
        const double d2 = (entry.point.p - p_map).squaredNorm();
        if (d2 < best2 && entry.seen_m >= oldest_m_) {
          best2 = d2;
          best = &entry.point;
        }
      }
    }
  }
  if (best) distance2_m2 = best2;
  return best;
}

void PointMap::visit(const Eigen::Vector2d& centre_map, double half_side_m,
                     const std::function<void(const Eigen::Vector2d&)>& visitor) const {
  const std::int32_t y0 = index(centre_map.y() - half_side_m);
  const std::int32_t y1 = index(centre_map.y() + half_side_m);
  const std::int32_t x1 = index(centre_map.x() + half_side_m);
  for (std::int32_t ix = index(centre_map.x() - half_side_m); ix <= x1; ++ix) {
    for (std::int32_t iy = y0; iy <= y1; ++iy) {
      const Cell& cell = cells_[slot(ix, iy)];
      if (cell.ix != ix || cell.iy != iy) continue;
      for (const Entry& entry : cell.entries) {
        if (entry.seen_m >= oldest_m_) visitor(entry.point.p);
      }
    }
  }
}

}  // namespace orchard::pose
