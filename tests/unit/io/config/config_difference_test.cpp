// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config_difference.hpp"

#include <gmock/gmock.h>

#include "io/config/config.hpp"
#include "io/config/scene_rig.hpp"

namespace orchard::io {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> lines(const std::string& a, const std::string& b) {
  return difference_lines(config_differences(a, b));
}

TEST(ConfigDifferences, NameEachKeyOnceInTheOrderOfTheFirst) {
  EXPECT_THAT(lines("laser:\n  x: 1\n  y: [1, 2]\ndetector:\n  width:\n    z: a\n  gone: 3\n",
                    "detector:\n  width:\n    z: b\n  new: 4\nlaser:\n  y: [1, 3]\n  x: 1\n"),
              ElementsAre("laser.y: [1, 2] -> [1, 3]", "detector.width.z: a -> b",
                          "detector.gone: 3 -> (none)", "detector.new: (none) -> 4"));
}

TEST(ConfigDifferences, OfNetworkAndSimulationAreNone) {
  EXPECT_THAT(lines("lcm:\n  url: a\ndrivers:\n  laser:\n    device: c\nsimulation:\n  x: 1\n",
                    "lcm:\n  url: b\n"),
              IsEmpty());
}

TEST(ConfigDifferences, ManyAreCounted) {
  const auto all =
      lines(effective_config(scene_rig("tubes")), effective_config(scene_rig("orchard")));
  EXPECT_LE(all.size(), 21u);
  std::string many = "detector:\n";
  for (int i = 0; i < 30; ++i) many += "  k" + std::to_string(i) + ": 1\n";
  EXPECT_EQ(lines(many, "").back(), "and 10 more");
}

TEST(ConfigDifferences, WhatIsNoYamlIsRefused) {
  EXPECT_THROW(config_differences("a: [", ""), ConfigError);
}

TEST(SceneRig, IsTheFileOfTheSceneAsItStands) {
  for (const std::string scene : {"tubes", "orchard", "park"}) {
    EXPECT_EQ(effective_config(scene_rig(scene)),
              effective_config(load_config(ORCHARD_SOURCE_DIR "/config/" + scene + ".yaml")));
  }
  EXPECT_EQ(effective_config(scene_rig("board")), effective_config(scene_rig("tubes")));
  EXPECT_EQ(effective_config(scene_rig("forest")), effective_config(Config{}));
}

}  // namespace
}  // namespace orchard::io
