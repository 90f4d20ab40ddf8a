// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/heights.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::square;
using pose::GroundPoint;

// physical: as far as trunks are seen, and both aisles of a row are nearer.
constexpr double kNear_m = 8.0;
// derived: of the nearest point's distance; beyond, the ground is another bank or aisle's.
constexpr double kBeyondNearest_m = 4.0;
// physical: slopes of even ground differ by two per cent from one body's length to the next.
constexpr double kLeastScatter = 0.02;
// derived: heights that are less certain tell nothing of an orchard's slopes.
constexpr double kMostSd_m = 1.0;

/// A plane about a trunk: its height there, and its gradient.
struct Plane {
  Vector3d at = Vector3d::Zero();
  Matrix3d information = Matrix3d::Zero();
};

/// Fits the plane, for a scatter of slopes from one body's length to the next. Heights walk at
/// random then. Neighbours on one pass share what is wrong with them, so the best height and the
/// best slope count once each, and the others only balance them.
Plane fit(const std::vector<const GroundPoint*>& points, const Vector2d& p, double scatter) {
  Matrix3d of_heights = Matrix3d::Zero(), of_slopes = Matrix3d::Zero();
  Vector3d heights = Vector3d::Zero(), slopes = Vector3d::Zero();
  double height_sum = 0.0, height_most = 0.0, slope_sum = 0.0, slope_most = 0.0;
  for (const GroundPoint* point : points) {
    const Vector2d way_m = Vector2d(point->x_m, point->y_m) - p;
    const double weight = 1.0 / (point->variance_m2 +
                                 square(scatter) * pose::kBody_m * (way_m.norm() + pose::kBody_m));
    const Vector3d a(1.0, way_m.x(), way_m.y());
    of_heights += weight * a * a.transpose();
    heights += weight * point->z_m * a;
    height_sum += weight, height_most = std::max(height_most, weight);
    if (!point->gradient) continue;
    const double slope_weight = 1.0 / square(scatter);
    of_slopes.diagonal().tail<2>().array() += slope_weight;
    slopes.tail<2>() += slope_weight * *point->gradient;
    slope_sum += slope_weight, slope_most = slope_weight;
  }
  Plane plane;
  const double height_share = height_most / height_sum;
  const double slope_share = slope_sum > 0.0 ? slope_most / slope_sum : 0.0;
  plane.information = height_share * of_heights + slope_share * of_slopes;
  plane.information.diagonal().tail<2>().array() += 1.0 / square(pose::kDrivenSlopeSd);
  plane.at = plane.information.ldlt().solve(height_share * heights + slope_share * slopes);
  return plane;
}

/// How much the slopes nearby differ from the plane's, or where no tilt was known, heights.
double scatter_of(const std::vector<const GroundPoint*>& points, const Vector2d& p,
                  const Plane& plane) {
  double sum = 0.0;
  int num = 0;
  for (const GroundPoint* point : points) {
    if (point->gradient) {
      sum += (*point->gradient - plane.at.tail<2>()).squaredNorm();
      num += 2;
    } else {
      const Vector2d way_m = Vector2d(point->x_m, point->y_m) - p;
      const double off_m = point->z_m - plane.at.x() - plane.at.tail<2>().dot(way_m);
      sum += square(off_m) / (pose::kBody_m * (way_m.norm() + pose::kBody_m));
      ++num;
    }
  }
  return std::max(kLeastScatter, std::sqrt(sum / num));
}

}  // namespace

void set_heights(const pose::GroundProfile& ground, std::vector<Landmark>& landmarks) {
  if (ground.points.empty()) return;
  std::vector<Vector2d> places;
  for (const GroundPoint& point : ground.points) places.emplace_back(point.x_m, point.y_m);
  const geometry::IndexedPoints index(std::move(places));
  for (Landmark& l : landmarks) {
    const Vector2d p(l.x_m, l.y_m);
    const std::int32_t nearest = index.nearest(p, kNear_m);
    if (nearest < 0) continue;
    const double nearest_m = (index[static_cast<std::size_t>(nearest)] - p).norm();
    std::vector<const GroundPoint*> points;
    for (const std::int32_t i : index.within(p, nearest_m + kBeyondNearest_m)) {
      points.push_back(&ground.points[static_cast<std::size_t>(i)]);
    }
    const Plane level = fit(points, p, kLeastScatter);
    const Plane plane = fit(points, p, scatter_of(points, p, level));
    const double variance_m2 = plane.information.inverse()(0, 0) + ground.shared_variance_m2;
    if (!(variance_m2 < square(kMostSd_m))) continue;
    l.z_m = plane.at.x();
    l.z_sd_m = std::sqrt(variance_m2);
  }
}

}  // namespace orchard::mapping
