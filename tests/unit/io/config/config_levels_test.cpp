// SPDX-License-Identifier: BSD-3-Clause
// Keys for users, keys for experts; keys of a log of another version.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "io/config/config.hpp"
#include "io/config/config_error.hpp"

namespace orchard::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A key of a printed configuration.
struct PrintedKey {
  std::string path;
  bool is_expert = false;
};

std::vector<PrintedKey> keys_of(const std::string& printed, bool with_sections = false) {
  std::vector<PrintedKey> keys;
  std::vector<std::string> sections;
  std::istringstream text(printed);
  for (std::string line; std::getline(text, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    const std::size_t colon = line.find(':');
    sections.resize(indent / 2);
    std::string path;
    for (const std::string& section : sections) path += section + ".";
    path += line.substr(indent, colon - indent);
    const bool is_section = line.compare(colon, 4, ":  #") == 0;
    if (is_section) sections.push_back(line.substr(indent, colon - indent));
    if (is_section && !with_sections) continue;
    keys.push_back({path, line.find("  # expert: ") != std::string::npos});
  }
  return keys;
}

TEST(ConfigLevels, AUserIsShownAtMostSixtyKeysBesideDriversAndSimulation) {
  int num_shown = 0;
  for (const PrintedKey& key : keys_of(print_config(Config(), PrintedKeys::kUser))) {
    EXPECT_FALSE(key.is_expert) << key.path;
    num_shown += key.path.rfind("drivers.", 0) != 0 && key.path.rfind("simulation.", 0) != 0;
  }
  EXPECT_LE(num_shown, 60);
  EXPECT_GE(num_shown, 40);
}

TEST(ConfigLevels, WhatUsersAndExpertsAreShownReadsBackAsTheSame) {
  Config config;
  config.pose.slam.submap_length_m = 9.5;   // for experts
  config.detector.edges.canny_low = 17;     // in a section for experts
  config.camera.extrinsics.delta_m[1] = 1;  // for users
  const std::string user = print_config(config, PrintedKeys::kUser);
  EXPECT_EQ(effective_config(parse_config(user, "user")), effective_config(config));
  const std::string all = print_config(config, PrintedKeys::kAll);
  EXPECT_EQ(effective_config(parse_config(all, "all")), effective_config(config));
  EXPECT_THAT(user, HasSubstr("submap_length_m: 9.5  # expert: m in"));
  EXPECT_THAT(user, HasSubstr("  edges:  # expert: "));
  EXPECT_THAT(user, Not(HasSubstr("canny_high:")));
  EXPECT_THAT(all, HasSubstr("canny_high"));
  EXPECT_THAT(print_config(Config(), PrintedKeys::kUser), Not(HasSubstr("\n  edges:")));
}

TEST(RecordedConfig, KeysOfAnotherReleaseAreNotedInALogAndRefusedInAFile) {
  const std::string yaml =
      "detector:\n  adaptation:\n    enabled: true\n  tree_threshold: 0.3\nmapper:\n  presence: "
      "1\n  absence: 2\n";
  const RecordedConfig recorded = parse_recorded_config(yaml, "the rig in a.lcm");
  EXPECT_EQ(recorded.config.detector.tree_threshold, 0.3);
  EXPECT_THAT(
      recorded.notes,
      ElementsAre(HasSubstr("detector.adaptation = (a section) is no key of this version"),
                  HasSubstr("mapper.presence = 1, absence = 2 are no keys of this version")));
  EXPECT_THAT(parse_recorded_config(effective_config(Config()), "").notes, IsEmpty());
  EXPECT_THROW(parse_recorded_config("detector: {tree_threshold: 9}", ""), ConfigError);
  EXPECT_THROW(parse_config(yaml, "rig.yaml"), ConfigError);
}

}  // namespace
}  // namespace orchard::io
