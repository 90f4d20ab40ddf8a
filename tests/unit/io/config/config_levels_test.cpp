// SPDX-License-Identifier: BSD-3-Clause
// Keys for users, keys for experts, and keys of an earlier version.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "io/config/config.hpp"
#include "io/config/old_keys.hpp"

namespace orchard::io {
namespace {

using ::testing::Contains;
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

std::vector<std::string> warnings_of(const std::string& yaml) {
  return parse_config_with_warnings(yaml, "rig.yaml").warnings;
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

TEST(OldKeys, ARenamedKeyIsReadWithAWarningThatNamesTheNewOne) {
  const LoadedConfig loaded = parse_config_with_warnings(
      "pose:\n  slam:\n    sighting_sd_m: 0.3\nmapper:\n  presence:\n    enabled: false\n",
      "rig.yaml");
  EXPECT_EQ(loaded.config.pose.slam.observation_sd_m, 0.3);
  EXPECT_FALSE(loaded.config.mapper.existence.enabled);
  EXPECT_THAT(loaded.warnings,
              ElementsAre(HasSubstr("rig.yaml:3: pose.slam.sighting_sd_m is now called "
                                    "observation_sd_m"),
                          HasSubstr("rig.yaml:6: mapper.presence is now called existence")));
}

TEST(OldKeys, AMistakeInARenamedKeyIsRefusedAsInTheNewOne) {
  EXPECT_THROW(warnings_of("mapper: {apart_m: 50}"), ConfigError);
  EXPECT_THROW(warnings_of("mapper: {presence: {nonsense: 1}}"), ConfigError);
}

TEST(OldKeys, BothNamesOfOneKeyAreRefused) {
  try {
    parse_config("mapper: {apart_m: 0.5, split_distance_m: 0.6}", "rig.yaml");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.problems(),
                ElementsAre(HasSubstr(
                    "mapper.apart_m: is given twice, also by its new name split_distance_m")));
  }
}

TEST(OldKeys, AKeyThatIsFixedNowIsIgnoredWithAWarningUnlessItSaysTheSame) {
  EXPECT_THAT(warnings_of("pose: {slam: {solve_growth: 0.10}}"), IsEmpty());
  EXPECT_THAT(
      warnings_of("pose:\n  slam:\n    solve_growth: 0.2\n"),
      ElementsAre("rig.yaml:3: pose.slam.solve_growth = 0.2 is ignored: it is now fixed at 0.1"));
  EXPECT_THAT(warnings_of("mapper: {presence: {past_share: 0.9}}"),
              Contains(HasSubstr("mapper.existence.past_share = 0.9 is ignored")));
  EXPECT_THAT(
      warnings_of("mapper: {existence: {seen_rate: 0.5}}"),
      Contains(HasSubstr("mapper.existence.seen_rate = 0.5 is ignored: its function was removed")));
}

TEST(OldKeys, EveryOldNameLeadsToAKeyThatIsThereAndIsNoneItself) {
  std::set<std::string> present;
  for (const PrintedKey& key : keys_of(print_config(Config()), true)) present.insert(key.path);
  for (const OldKey& old : old_keys()) {
    const std::string path(old.path);
    EXPECT_EQ(present.count(path), 0u) << path << " is a key, and in the table of old ones";
    const std::string section = path.substr(0, path.rfind('.'));
    EXPECT_EQ(present.count(section), 1u) << section;
    if (old.name != nullptr) {
      EXPECT_EQ(present.count(section + "." + old.name), 1u) << path;
    }
  }
}

}  // namespace
}  // namespace orchard::io
