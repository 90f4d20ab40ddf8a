// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/point_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "geometry/pose2.hpp"
#include "geometry/symmetric.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

using geometry::transform;
namespace {

// derived: several beams of one surface, but not the next trunk, determine a normal [m].
constexpr double kNormalRadius_m = 0.30;
constexpr std::ptrdiff_t kNeighbours = 6;  // to each side
constexpr int kPointsOfSurfaceMin = 4;

void find_normal(std::vector<SurfacePoint>& points, std::ptrdiff_t i) {
  const auto size = static_cast<std::ptrdiff_t>(points.size());
  SurfacePoint& point = points[i];
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  int count = 0;
  const double radius2 = kNormalRadius_m * kNormalRadius_m;
  for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - kNeighbours);
       j <= std::min(size - 1, i + kNeighbours); ++j) {
    const Eigen::Vector2d arm = points[j].p - point.p;
    if (arm.squaredNorm() > radius2) continue;
    sum += arm;
    squares += arm * arm.transpose();
    ++count;
  }
  if (count < kPointsOfSurfaceMin) return;
  const Eigen::Vector2d mean = sum / count;
  const geometry::Axes2 axes = geometry::axes_of(squares / count - mean * mean.transpose());
  const double thickness = std::max(0.0, axes.values(0));
  const double length = axes.values(1);
  if (!(length > kSurfaceLengthSd_m * kSurfaceLengthSd_m)) return;
  if (thickness > kFlatnessMax * length) return;
  point.normal = axes.directions.col(0);
  point.flat = true;
}

// derived: extent beyond the scanner's max range [m]; spacing above the noise of a range; cells
// about as large as the last iterations' pairs, whose number of points bounds the cost of a query.
constexpr double kMapRadius_m = 50.0;
constexpr double kMapSpacing_m = 0.07;
constexpr int kMapCellPointsMax = 16;
constexpr double kMapCell_m = 0.4;

// derived: a raster resolves half its kernel, which ends at two standard deviations.
constexpr int kCellsPerKernel = 2;
constexpr int kReachCells = 2 * kCellsPerKernel;

}  // namespace

std::vector<SurfacePoint> surface_points(const laser::Scan& scan, const laser::LaserConfig& mount,
                                         const laser::BlindSector& blind,
                                         const Eigen::Vector3d& velocity,
                                         const ScanMotionConfig& config) {
  const Eigen::Vector3d T_base_laser(mount.mount_x_m + scan.sway_x_m,
                                     mount.mount_y_m + scan.sway_y_m, mount.mount_yaw_rad);
  const double nearest_m = std::max(scan.range_min_m, config.range_min_m);
  const double farthest_m = std::min(scan.range_max_m, config.range_max_m);
  const bool moves = config.deskew && scan.beam_period_us > 0.0;
  std::vector<SurfacePoint> points;
  points.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = scan.ranges_m[i];
    // Drivers report range_max_m if there is no return.
    if (!(range_m >= nearest_m && range_m <= farthest_m) || range_m >= scan.range_max_m) continue;
    const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
    if (blind.contains(bearing_rad)) continue;
    SurfacePoint point;
    point.p = transform(T_base_laser,
                        range_m * Eigen::Vector2d(std::cos(bearing_rad), std::sin(bearing_rad)));
    if (moves) point.p = transform(velocity * (1e-6 * scan.beam_period_us * i), point.p);
    if (point.p.allFinite()) points.push_back(point);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    find_normal(points, static_cast<std::ptrdiff_t>(i));
  }
  return points;
}

std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double side_m) {
  if (side_m <= 0.0) return points;
  std::vector<SurfacePoint> kept;
  std::unordered_set<std::uint64_t> taken;
  for (const SurfacePoint& point : points) {
    const auto ix = static_cast<std::int32_t>(std::floor(point.p.x() / side_m));
    const auto iy = static_cast<std::int32_t>(std::floor(point.p.y() / side_m));
    const std::uint64_t square =
        (static_cast<std::uint64_t>(static_cast<std::uint32_t>(ix)) << 32) |
        static_cast<std::uint32_t>(iy);
    if (taken.insert(square).second) kept.push_back(point);
  }
  return kept;
}

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

LikelihoodField::LikelihoodField(const PointMap& map, const Eigen::Vector2d& centre_map,
                                 double half_side_m, double kernel_m)
    : cell_m_(kernel_m / kCellsPerKernel),
      side_(2 * static_cast<int>(std::ceil(half_side_m / cell_m_)) + 1),
      corner_map_(centre_map.array() - 0.5 * side_ * cell_m_),
      fits_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0) {
  std::uint8_t stamp[2 * kReachCells + 1][2 * kReachCells + 1];
  for (int dy = -kReachCells; dy <= kReachCells; ++dy) {
    for (int dx = -kReachCells; dx <= kReachCells; ++dx) {
      const double u2 =
          static_cast<double>(dx * dx + dy * dy) / (kCellsPerKernel * kCellsPerKernel);
      stamp[dy + kReachCells][dx + kReachCells] =
          static_cast<std::uint8_t>(std::lround(255.0 * std::exp(-0.5 * u2)));
    }
  }
  map.visit(centre_map, half_side_m, [&](const Eigen::Vector2d& p_map) {
    const Eigen::Vector2d in_cells = (p_map - corner_map_) / cell_m_;
    const int ix = static_cast<int>(std::floor(in_cells.x()));
    const int iy = static_cast<int>(std::floor(in_cells.y()));
    if (ix < 0 || iy < 0 || ix >= side_ || iy >= side_) return;
    std::uint8_t* cell = &fits_[static_cast<std::size_t>(iy) * side_ + ix];
    if (*cell == 255) return;
    for (int dy = std::max(-kReachCells, -iy); dy <= std::min(kReachCells, side_ - 1 - iy); ++dy) {
      for (int dx = std::max(-kReachCells, -ix); dx <= std::min(kReachCells, side_ - 1 - ix);
           ++dx) {
        std::uint8_t& fit = cell[dy * side_ + dx];
        fit = std::max(fit, stamp[dy + kReachCells][dx + kReachCells]);
      }
    }
  });
}

double LikelihoodField::score(const std::vector<Eigen::Vector2d>& arms_map,
                              const Eigen::Vector2d& base_map) const {
  const Eigen::Vector2d shift = (base_map - corner_map_) / cell_m_;
  std::int64_t sum = 0;
  for (const Eigen::Vector2d& arm : arms_map) {
    const double x = shift.x() + arm.x() / cell_m_;
    const double y = shift.y() + arm.y() / cell_m_;
    if (!(x >= 0.0 && y >= 0.0 && x < side_ && y < side_)) continue;
    sum += fits_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
                 static_cast<std::size_t>(x)];
  }
  return arms_map.empty()
             ? 0.0
             : static_cast<double>(sum) / (255.0 * static_cast<double>(arms_map.size()));
}

}  // namespace orchard::pose
