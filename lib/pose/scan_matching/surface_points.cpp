// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/surface_points.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "geometry/pose2.hpp"

namespace orchard::pose {
using geometry::transform;

namespace {

/// Radius of the neighbouring returns that determine a normal [m]: several beams of one surface,
/// but not the next trunk.
constexpr double kNormalRadius_m = 0.30;

/// Max ratio of the smallest to the largest variance of the neighbours of a flat surface.
constexpr double kFlatnessMax = 0.05;

constexpr std::ptrdiff_t kNeighbours = 6;  ///< to each side
constexpr int kPointsOfSurfaceMin = 4;
/// Min extent of a surface with a normal (1-sigma along it).
constexpr double kSurfaceLengthSd_m = 0.06;

void find_normal(std::vector<SurfacePoint>& points, std::ptrdiff_t i) {
  const auto size = static_cast<std::ptrdiff_t>(points.size());
  SurfacePoint& point = points[static_cast<std::size_t>(i)];
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  int count = 0;
  const double radius2 = kNormalRadius_m * kNormalRadius_m;
  for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - kNeighbours);
       j <= std::min(size - 1, i + kNeighbours); ++j) {
    const Eigen::Vector2d arm = points[static_cast<std::size_t>(j)].p - point.p;
    if (arm.squaredNorm() > radius2) continue;
    sum += arm;
    squares += arm * arm.transpose();
    ++count;
  }
  if (count < kPointsOfSurfaceMin) return;
  const Eigen::Vector2d mean = sum / count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(squares / count - mean * mean.transpose());
  const double thickness = std::max(0.0, axes.eigenvalues()(0));
  const double length = axes.eigenvalues()(1);
  if (!(length > kSurfaceLengthSd_m * kSurfaceLengthSd_m)) return;
  if (thickness > kFlatnessMax * length) return;
  point.normal = axes.eigenvectors().col(0);
  point.flat = true;
}

}  // namespace

std::vector<SurfacePoint> surface_points(const laser::Scan& scan, const laser::LaserConfig& mount,
                                         const laser::BlindSector& blind,
                                         const Eigen::Vector3d& velocity,
                                         const ScanMotionConfig& config) {
  const Eigen::Vector3d T_base_laser(mount.mount_x_m, mount.mount_y_m, mount.mount_yaw_rad);
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

}  // namespace orchard::pose
