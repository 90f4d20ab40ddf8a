// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/trunk_observation.hpp"

#include <gtest/gtest.h>

#include "unit/detection/tube_rig.hpp"

namespace orchard::calibration {
namespace {

using test::blue_tube;
using test::brown_tube;

TEST(TrunkObservation, ObservationsAtEverythingWhateverItsWidthAndColour) {
  const auto rig = test::tube_rig();
  const std::vector<test::Tube> tubes{brown_tube(1.5, 0.5), brown_tube(1.5, 0.0, 0.17),
                                      blue_tube(1.5, -0.5)};
  const auto image = test::picture_of_tubes(tubes, rig);
  const auto observations = observe_trunks(test::scan_of(tubes), &image, rig, {4, false});
  ASSERT_EQ(observations.size(), 3u);  // from right to left
  EXPECT_NEAR(vision::dominant_hue_deg(observations[0].hues, 36), 215.0, 6.0);
  EXPECT_NEAR(observations[1].width_m, 0.17, 0.01);
  EXPECT_NEAR(vision::dominant_hue_deg(observations[2].hues, 36), 27.0, 6.0);
  EXPECT_NEAR(observations[2].x_m, 1.5, 0.015);
  EXPECT_NEAR(observations[2].y_m, 0.5, 0.015);
  EXPECT_FALSE(observations[2].in_map);
}

TEST(TrunkObservation, LeavesOutWhatIsHiddenThinOrOutOfView) {
  const auto rig = test::tube_rig();
  const std::vector<test::Tube> tubes{brown_tube(1.0, 0.0), brown_tube(2.0, 0.11),
                                      brown_tube(0.0, 1.5), brown_tube(3.0, -0.8, 0.03)};
  const auto image = test::picture_of_tubes(tubes, rig);
  EXPECT_EQ(observe_trunks(test::scan_of(tubes), &image, rig, {4, false}).size(), 1u);
}

TEST(TrunkObservation, ARigWithACameraLearnsNothingWithoutAPicture) {
  const std::vector<test::Tube> tubes{brown_tube(1.5, 0.5)};
  EXPECT_TRUE(observe_trunks(test::scan_of(tubes), nullptr, test::tube_rig(), {4, false}).empty());
  const auto observations =
      observe_trunks(test::scan_of(tubes), nullptr, test::tube_rig({}, false), {4, false});
  ASSERT_EQ(observations.size(), 1u);
  EXPECT_EQ(observations[0].hues.num_pixels, 0);
}

}  // namespace
}  // namespace orchard::calibration
