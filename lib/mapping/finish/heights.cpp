// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/heights.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using geometry::square;
using pose::GroundPoint;

// derived: heights that are less certain tell nothing of an orchard's slopes.
constexpr double kMostSd_m = 1.0;
// derived: farther from any way the slope alone makes a height less certain than that.
constexpr double kNear_m = kMostSd_m / pose::kDrivenSlopeSd;
// derived: of so many heights the roughness of the ground is known to a third, a class to one.
constexpr std::size_t kHeights = 24;
// physical: ISO 8608:2016. The density of displacements at 0.1 cycles/m of class A, the best
// roads; that of each class up to H, the eighth, is four times that of the one before.
constexpr double kBestRoad_m3 = 16e-6;
constexpr double kPerClass = 4.0;
constexpr int kClasses = 8;
// derived: a density G n0^2 / n^2 is a random walk: heights a distance d from each other differ by
// a variance of 2 pi^2 n0^2 G d, where n0 is 0.1 cycles/m.
constexpr double kWalkOfDensity_perm2 = 2.0 * geometry::kPi * geometry::kPi * 0.1 * 0.1;
// derived: a height is the mean over a body's length, of means over a metre of way: so far from its
// middle, and from each other, are two points of that in the mean.
constexpr double kFromMiddle_m = pose::kBody_m / 3.0;
constexpr double kWithinMean_m = pose::kBody_m * 7.0 / 15.0;

// physical: a scanner across trunks is at most a metre above the ground, where the crowns begin;
// the root of the mean square of all heights up to that. Where no tilt is known scans are taken as
// level, and on a slope g a scanner h above the ground puts its trees h g uphill, by h g^2 too
// high.
constexpr double kScannerHeight_m = 0.58;

/// A height of the ground near a trunk.
struct Height {
  Vector2d way_m = Vector2d::Zero();  ///< from the trunk
  double z_m = 0.0, variance_m2 = 0.0;
  double own_variance_m2 = 0.0;  ///< which the others do not share
  bool has_tilt = false;
  double tilt_sd_m = 0.0;  ///< by which an error of the tilt lifts it, or less than 0 lowers it
};

struct Estimate {
  double z_m = 0.0, variance_m2 = 0.0, unlikely = 0.0;
};

/// The heights that tell of a trunk's ground: those below the wheels, left and right by what the
/// tilt tells, the nearest first. One half a body's length beside another tells no more than that.
std::vector<Height> heights_near(const pose::GroundProfile& ground,
                                 const std::vector<std::int32_t>& near, const Vector2d& p) {
  std::vector<Height> all;
  for (const std::int32_t i : near) {
    const GroundPoint& point = ground[static_cast<std::size_t>(i)];
    const Vector2d way_m = Vector2d(point.x_m, point.y_m) - p;
    if (!point.gradient) {
      all.push_back({way_m, point.z_m, point.variance_m2, point.own_variance_m2});
      continue;
    }
    for (const double left_m : {-0.5 * pose::kBody_m, 0.5 * pose::kBody_m}) {
      const Vector2d off_m = left_m * Vector2d(-std::sin(point.yaw_rad), std::cos(point.yaw_rad));
      all.push_back({way_m + off_m, point.z_m + point.gradient->dot(off_m), point.variance_m2,
                     point.own_variance_m2, true, left_m * std::sqrt(point.slope_variance)});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Height& a, const Height& b) {
    return a.way_m.squaredNorm() < b.way_m.squaredNorm();
  });
  std::vector<Height> taken;
  for (const Height& h : all) {
    const auto is_beside = [&h](const Height& o) {
      return (h.way_m - o.way_m).squaredNorm() < square(0.5 * pose::kBody_m);
    };
    if (std::none_of(taken.begin(), taken.end(), is_beside)) taken.push_back(h);
    if (taken.size() == kHeights) break;
  }
  return taken;
}

/// By how much two heights' ways from the trunk are one, twice [m]: a class of roughness makes a
/// variance of it.
MatrixXd shared_ways_m(const std::vector<Height>& heights) {
  const auto num = static_cast<Eigen::Index>(heights.size());
  MatrixXd shared_m(num, num);
  VectorXd from_trunk_m(num);  // the mean distance of the points whose mean a height is
  for (Eigen::Index i = 0; i < num; ++i) {
    const Height& a = heights[static_cast<std::size_t>(i)];
    from_trunk_m(i) = std::hypot(a.way_m.norm(), kFromMiddle_m);
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Height& b = heights[static_cast<std::size_t>(j)];
      const double apart_m = std::hypot((a.way_m - b.way_m).norm(), kWithinMean_m);
      shared_m(i, j) = from_trunk_m(i) + from_trunk_m(j) - apart_m;
    }
  }
  return shared_m;
}

/// The height at the trunk on ground of a roughness: a plane, and from the trunk on a random walk.
Estimate estimate(const std::vector<Height>& heights, const MatrixXd& shared_m, double walk_m2pm) {
  const auto num = static_cast<Eigen::Index>(heights.size());
  MatrixXd K(num, num), X(num, 3);
  VectorXd z(num);
  for (Eigen::Index i = 0; i < num; ++i) {
    const Height& a = heights[static_cast<std::size_t>(i)];
    X.row(i) << 1.0, a.way_m.x(), a.way_m.y();
    z(i) = a.z_m - heights.front().z_m;
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Height& b = heights[static_cast<std::size_t>(j)];
      K(i, j) = 0.5 * walk_m2pm * shared_m(i, j) + std::min(a.variance_m2, b.variance_m2) +
                a.tilt_sd_m * b.tilt_sd_m;
    }
    K(i, i) += a.own_variance_m2;
  }
  const Eigen::LLT<MatrixXd> of_heights(K);
  const MatrixXd weighted = of_heights.solve(X);
  Matrix3d information = X.transpose() * weighted;
  information.diagonal().tail<2>().array() += 1.0 / square(pose::kDrivenSlopeSd);
  const Eigen::LLT<Matrix3d> of_plane(information);
  const Vector3d seen = weighted.transpose() * z;
  const Vector3d plane = of_plane.solve(seen);
  const auto log_of = [](const auto& llt) {
    return 2.0 * llt.matrixLLT().diagonal().array().log().sum();
  };
  double variance_m2 = of_plane.solve(Vector3d::UnitX()).x();
  if (!heights.front().has_tilt) {
    const Matrix3d of_slope = of_plane.solve(Matrix3d::Identity());
    const double slope2 = plane.tail<2>().squaredNorm() + of_slope.diagonal().tail<2>().sum();
    variance_m2 += square(kScannerHeight_m * slope2);
  }
  return {heights.front().z_m + plane.x(), variance_m2,
          log_of(of_heights) + log_of(of_plane) + z.dot(of_heights.solve(z)) - seen.dot(plane)};
}

/// The mean over the classes of roughness, each as likely as it makes these heights.
Estimate estimate(const std::vector<Height>& heights) {
  const MatrixXd shared_m = shared_ways_m(heights);
  std::vector<Estimate> of_class;
  double least = std::numeric_limits<double>::infinity();
  for (double density_m3 = kBestRoad_m3; of_class.size() < kClasses; density_m3 *= kPerClass) {
    of_class.push_back(estimate(heights, shared_m, kWalkOfDensity_perm2 * density_m3));
    least = std::min(least, of_class.back().unlikely);
  }
  double sum = 0.0, z_m = 0.0, variance_m2 = 0.0;
  for (Estimate& e : of_class) sum += e.unlikely = std::exp(-0.5 * (e.unlikely - least));
  for (const Estimate& e : of_class) z_m += e.unlikely / sum * e.z_m;
  for (const Estimate& e : of_class) {
    variance_m2 += e.unlikely / sum * (e.variance_m2 + square(e.z_m - z_m));
  }
  return {z_m, variance_m2, least};
}

}  // namespace

void set_heights(const pose::GroundProfile& ground, std::vector<Landmark>& landmarks) {
  if (ground.empty()) return;
  std::vector<Vector2d> places;
  for (const GroundPoint& point : ground) places.emplace_back(point.x_m, point.y_m);
  const geometry::IndexedPoints index(std::move(places));
  for (Landmark& l : landmarks) {
    const Vector2d p(l.x_m, l.y_m);
    const std::vector<Height> heights = heights_near(ground, index.within(p, kNear_m), p);
    if (heights.empty()) continue;
    const Estimate ground_here = estimate(heights);
    if (!(ground_here.variance_m2 < square(kMostSd_m))) continue;
    l.z_m = ground_here.z_m;
    l.z_sd_m = std::sqrt(ground_here.variance_m2);
  }
}

}  // namespace orchard::mapping
