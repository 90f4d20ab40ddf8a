// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "geometry/pose2.hpp"
#include "laser/scan.hpp"

namespace orchard::pose {
using geometry::compose;

/// Round trunks and straight walls, and exactly what a laser in base's origin sees of them.
struct CastWorld {
  struct Circle {
    Eigen::Vector2d centre;
    double radius_m;
  };
  struct Wall {
    Eigen::Vector2d from, to;
  };
  std::vector<Circle> circles;
  std::vector<Wall> walls;

  /// Range from `p` along a unit vector; infinite when nothing is there.
  double range_m(const Eigen::Vector2d& p, const Eigen::Vector2d& direction) const {
    double range = std::numeric_limits<double>::infinity();
    for (const Circle& circle : circles) {
      const Eigen::Vector2d to = circle.centre - p;
      const double along = to.dot(direction);
      const double discriminant =
          circle.radius_m * circle.radius_m - to.squaredNorm() + along * along;
      if (discriminant < 0.0) continue;
      const double hit = along - std::sqrt(discriminant);
      if (hit > 0.0) range = std::min(range, hit);
    }
    for (const Wall& wall : walls) {
      const Eigen::Vector2d side = wall.to - wall.from, to = wall.from - p;
      const double determinant = direction.x() * -side.y() + side.x() * direction.y();
      if (std::abs(determinant) < 1e-12) continue;
      const double hit = (to.x() * -side.y() + side.x() * to.y()) / determinant;
      const double fraction = (direction.x() * to.y() - direction.y() * to.x()) / determinant;
      if (hit > 0.0 && fraction >= 0.0 && fraction <= 1.0) range = std::min(range, hit);
    }
    return range;
  }

  /// A full turn of 897 beams to 20 m at T_map_base, moving by `T_base_end` during the sweep.
  laser::Scan scan(std::int64_t utime, const Eigen::Vector3d& T_map_base, std::mt19937* noise,
                   double range_sd_m = 0.0,
                   const Eigen::Vector3d& T_base_end = Eigen::Vector3d::Zero()) const {
    laser::Scan scan;
    scan.utime = utime;
    scan.bearing_min_rad = -geometry::kPi;
    scan.bearing_step_rad = 2.0 * geometry::kPi / 897.0;
    scan.range_min_m = 0.1;
    scan.range_max_m = 20.0;
    std::normal_distribution<double> error(0.0, 1.0);
    for (int i = 0; i < 897; ++i) {
      const Eigen::Vector3d T = compose(T_map_base, T_base_end * (i / 897.0));
      const double bearing_rad = scan.bearing_rad(i) + T.z();
      double range = range_m(T.head<2>(), {std::cos(bearing_rad), std::sin(bearing_rad)});
      if (noise) range += range_sd_m * error(*noise);
      scan.ranges_m.push_back(range < scan.range_max_m ? static_cast<float>(range) : 0.0f);
    }
    return scan;
  }
};

/// Four rows of trunks, 3 m apart in rows 4 m apart, none exactly in its place.
inline CastWorld orchard_world() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> astray(-0.3, 0.3);
  std::uniform_real_distribution<double> radius(0.06, 0.15);
  CastWorld world;
  for (int row = 0; row < 4; ++row) {
    for (int tree = 0; tree < 10; ++tree) {
      const double x_m = 3.0 * tree + astray(random), y_m = 4.0 * row - 6.0 + astray(random);
      world.circles.push_back({{x_m, y_m}, radius(random)});
    }
  }
  return world;
}

}  // namespace orchard::pose
