// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "system/tube_scene/tube_scene_run.hpp"

namespace orchard::test {
namespace {

/// A slice of the seeds that `experiment run tubes` maps; the rig was calibrated on
/// others.
class TubeScene : public testing::TestWithParam<std::uint64_t> {};

TEST_P(TubeScene, IsMappedAsInThePaper) {
  const io::Config config = io::load_config(ORCHARD_SOURCE_DIR "/config/tubes.yaml");
  const evaluation::MapEvaluation evaluation = run_tube_scene(GetParam(), config);
  ASSERT_EQ(evaluation.num_trees, 12);
  ASSERT_EQ(evaluation.num_objects, 4);
  for (const std::string& complaint : shortcomings(evaluation)) ADD_FAILURE() << complaint;
}

INSTANTIATE_TEST_SUITE_P(Seeds, TubeScene, testing::Values(1, 2, 3, 4, 5, 6, 7, 8));

TEST(TubeScene, ARigThatKnowsNoTrunkIsFoundOut) {
  io::Config config = io::load_config(ORCHARD_SOURCE_DIR "/config/tubes.yaml");
  config.detector.width.mean_m = 0.30;
  EXPECT_FALSE(shortcomings(run_tube_scene(1, config)).empty());
}

}  // namespace
}  // namespace orchard::test
