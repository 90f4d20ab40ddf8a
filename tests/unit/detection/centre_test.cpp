// SPDX-License-Identifier: BSD-3-Clause
#include "detection/centre.hpp"

#include <gtest/gtest.h>

#include "geometry/angles.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::detection {
namespace {

TEST(Centre, ThePapersEquationsAreASpecialCase) {
  // Eqs. 11, 12: no heading, no lever arm, to the bark. The paper's X is right, its Y forward.
  const Rig rig = test::tube_rig();
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.bearing_rad = 0.4;
  segment.num_beams = 8;
  Detection d;
  place_in_base(d, segment, test::scan_of({}), false, rig);
  const double beta_rad = geometry::paper_bearing_rad(segment.bearing_rad);
  EXPECT_NEAR(-d.surface_y_m, 2.0 * std::sin(beta_rad), 1e-12);
  EXPECT_NEAR(d.surface_x_m, 2.0 * std::cos(beta_rad), 1e-12);
}

TEST(Centre, LiesHalfAWidthBehindTheBark) {
  const Rig rig = test::tube_rig();
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.width_m = 0.2;
  segment.num_beams = 8;
  Detection d;
  place_in_base(d, segment, test::scan_of({}), false, rig);
  EXPECT_NEAR(d.centre_x_m, 2.1, 1e-12);
}

TEST(Centre, ATrunksRadiusLeansOnTheModel) {
  const Rig rig = test::tube_rig();  // 90 mm, sd 10 mm
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.width_m = 0.11;
  segment.width_sd_m = 0.01;
  segment.num_beams = 8;
  Detection d;
  place_in_base(d, segment, test::scan_of({}), true, rig);
  EXPECT_NEAR(d.centre_x_m, 2.0 + 0.05, 1e-9);  // half way between 90 and 110 mm
  segment.width_sd_m = 1e-3;
  place_in_base(d, segment, test::scan_of({}), true, rig);
  EXPECT_NEAR(d.centre_x_m, 2.0 + 0.055, 2e-4);
}

TEST(Centre, AHiddenSideMakesTheBearingUncertain) {
  const Rig rig = test::tube_rig();
  laser::Segment segment;
  segment.range_m = 2.0;
  segment.width_m = 0.05;
  segment.num_beams = 4;
  Detection clear, hidden;
  hidden.occlusion = kOccludedLeft;
  place_in_base(clear, segment, test::scan_of({}), true, rig);
  place_in_base(hidden, segment, test::scan_of({}), true, rig);
  EXPECT_GT(hidden.covariance[2], clear.covariance[2] + 0.04 * 0.04);
  EXPECT_NEAR(hidden.covariance[0], clear.covariance[0], 1e-12);
}

}  // namespace
}  // namespace orchard::detection
