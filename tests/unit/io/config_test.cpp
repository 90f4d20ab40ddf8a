// SPDX-License-Identifier: BSD-3-Clause
#include "io/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace orchard::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> problems_of(const std::string& yaml) {
  try {
    parse_config(yaml, "rig.yaml");
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(Config, ThreeMistakesAreNamedAtOnceWithFileAndLine) {
  EXPECT_THAT(problems_of("detector:\n"
                          "  tree_threshold: 1.9\n"
                          "  width:\n"
                          "    meen_m: 0.09\n"
                          "camera:\n"
                          "  enabled: maybe\n"),
              ElementsAre("rig.yaml:6: camera.enabled = maybe: must be true or false",
                          HasSubstr("rig.yaml:4: detector.width.meen_m: unknown key; did you mean "
                                    "mean_m?"),
                          "rig.yaml:2: detector.tree_threshold = 1.9: must be in [0, 1]"));
}

TEST(Config, RefusesWhatIsNotWhatItShouldBe) {
  EXPECT_THAT(problems_of("- a\n- b\n"), ElementsAre(HasSubstr("must be sections")));
  EXPECT_THAT(problems_of("camera: {width_px: 3.5}\n"),
              ElementsAre("rig.yaml:1: camera.width_px = 3.5: must be a whole number"));
  EXPECT_THAT(problems_of("camera: {fc_px: [1, 2, 3]}\n"),
              ElementsAre(HasSubstr("must be a list of 2 numbers")));
  EXPECT_THAT(problems_of("camera: {fc_px: [200, nan]}\n"),
              ElementsAre(HasSubstr("camera.fc_px[1]")));
  EXPECT_THAT(problems_of("camera: 7\n"), ElementsAre(HasSubstr("must be a section")));
  EXPECT_THAT(problems_of("laser:\n  mount_x_m: 1\n  mount_x_m: 2\n"),
              ElementsAre(HasSubstr("stands here twice")));
  EXPECT_THAT(problems_of("lcm: {url: [a]}\n"), ElementsAre(HasSubstr("must be a text")));
  EXPECT_THAT(problems_of("pose: {mode: magic}\n"), ElementsAre(HasSubstr("must be one of fixes")));
  EXPECT_THAT(problems_of("a: [\n"), ElementsAre(HasSubstr("not YAML")));
}

TEST(Config, CrossedLimitsAreNamedWhereTheyStand) {
  EXPECT_THAT(problems_of("detector:\n  edges:\n    canny_low: 200\n    canny_high: 100\n"),
              ElementsAre("rig.yaml:3: detector.edges.canny_low = 200: must be below canny_high"));
}

TEST(Config, WhatIsPrintedReadsBackAsTheSame) {
  Config config;
  config.detector.width.mean_m = 0.1234567890123;
  config.camera.enabled = false;
  config.pose.mode = pose::PoseMode::kOdometry;
  config.camera.intrinsics.kc = {-0.1, 0.2, 0.3e-9, 4e-5, -5};
  const Config again = parse_config(print_config(config), "printed");
  EXPECT_EQ(effective_config(again), effective_config(config));
  EXPECT_EQ(config_hash(again), config_hash(config));
  EXPECT_NE(config_hash(again), config_hash(Config{}));
}

TEST(Config, AnEmptyFileIsAllDefaults) {
  EXPECT_EQ(effective_config(parse_config("", "empty")), effective_config(Config{}));
}

TEST(Config, AMissingFileIsNamed) {
  try {
    load_config("/nonexistent/rig.yaml");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nonexistent/rig.yaml"));
  }
}

}  // namespace
}  // namespace orchard::io
