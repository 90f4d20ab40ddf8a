// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/extent/extent.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::mapping {
namespace {

/// Area of a polygon (shoelace formula), positive when it runs counter-clockwise.
double area_m2(const std::vector<Eigen::Vector2d>& border) {
  double twice_m2 = 0.0;
  for (std::size_t i = 0; i < border.size(); ++i) {
    const Eigen::Vector2d& a = border[i];
    const Eigen::Vector2d& b = border[(i + 1) % border.size()];
    twice_m2 += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * twice_m2;
}

void expect_each_point_once(const std::vector<Eigen::Vector2d>& border) {
  for (std::size_t i = 0; i < border.size(); ++i) {
    EXPECT_GT((border[i] - border[(i + 1) % border.size()]).norm(), 1e-3) << i;
  }
}

Landmark thing_of(double width_m, double length_m) {
  Landmark l;
  l.x_m = 3.0;
  l.y_m = -2.0;
  l.width_m = width_m;
  l.length_m = length_m;
  l.direction_rad = 0.7;
  return l;
}

TEST(Outline, OfWhatIsRoundIsItsDiscAndNoPointTwice) {
  const auto border = outline_of(thing_of(1.2, 0.0));
  expect_each_point_once(border);
  const double disc_m2 = M_PI * 0.6 * 0.6;
  EXPECT_NEAR(area_m2(border), disc_m2, 0.02 * disc_m2);
}

TEST(Outline, OfAHedgeIsARectangleWithTwoHalfDiscs) {
  const auto border = outline_of(thing_of(0.8, 6.0));
  expect_each_point_once(border);
  const double area = M_PI * 0.4 * 0.4 + 5.2 * 0.8;
  EXPECT_NEAR(area_m2(border), area, 0.01 * area);
}

}  // namespace
}  // namespace orchard::mapping
