// SPDX-License-Identifier: BSD-3-Clause

// Keys for users, keys for experts; keys of a log of another version.
// Two keys that constrain each other: a configuration that crosses them is refused, and says so.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/config/config.hpp"
#include "io/config/config_difference.hpp"
#include "io/config/config_file.hpp"

namespace orchard::io {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

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

TEST(Config, AKeyIsReadByItsFormerNameUnlessBothAreGiven) {
  const auto carry = [](const char* keys) {
    return std::string("simulation: {carry: {") + keys + "}}\n";
  };
  EXPECT_EQ(parse_config(carry("to_alley: 3"), "rig.yaml").simulation.carry.to_aisle, 3);
  EXPECT_EQ(parse_config(carry("to_aisle: 4"), "rig.yaml").simulation.carry.to_aisle, 4);
  EXPECT_THAT(problems_of(carry("to_aisle: 4, to_alley: 3")),
              ElementsAre(HasSubstr("to_alley: unknown key; did you mean to_aisle?")));
  EXPECT_THAT(problems_of(carry("to_alley: x")), ElementsAre(HasSubstr("must be a whole number")));
}

TEST(Config, RefusesWhatIsNotWhatItShouldBe) {
  EXPECT_THAT(problems_of("- a\n- b\n"), ElementsAre(HasSubstr("must consist of sections")));
  EXPECT_THAT(problems_of("camera: {width_px: 3.5}\n"),
              ElementsAre("rig.yaml:1: camera.width_px = 3.5: must be a whole number"));
  EXPECT_THAT(problems_of("camera: {fc_px: [1, 2, 3]}\n"),
              ElementsAre(HasSubstr("must be a list of 2 numbers")));
  EXPECT_THAT(problems_of("camera: {fc_px: [200, nan]}\n"),
              ElementsAre(HasSubstr("camera.fc_px[1]")));
  EXPECT_THAT(problems_of("camera: 7\n"), ElementsAre(HasSubstr("must be a section")));
  EXPECT_THAT(problems_of("laser:\n  mount_x_m: 1\n  mount_x_m: 2\n"),
              ElementsAre(HasSubstr("is given twice; remove one")));
  EXPECT_THAT(problems_of("lcm: {url: [a]}\n"), ElementsAre(HasSubstr("must be a text")));
  EXPECT_THAT(
      problems_of("lcm:\n  url: memq://\r"),
      ElementsAre(
          "rig.yaml:2: lcm.url = memq://?: must not contain control characters (shown as ?)"));
  EXPECT_THAT(problems_of("lcm:\r\n  url: memq://\r\nlaser:\r\n"), ElementsAre());
  EXPECT_THAT(problems_of("pose: {mode: magic}\n"), ElementsAre(HasSubstr("must be one of fixes")));
  EXPECT_THAT(problems_of("a: [\n"), ElementsAre(HasSubstr("not valid YAML")));
}

std::string appearance_of(std::size_t num_weights, const std::string& scale = "0.5") {
  const auto list = [](std::size_t size, const std::string& number) {
    std::string text = "[";
    for (std::size_t i = 0; i < size; ++i) text += (i > 0 ? ", " : "") + number;
    return text + "]";
  };
  return "    mean: " + list(vision::kNumAppearanceFeatures, "-1.25") +
         "\n    scale: " + list(vision::kNumAppearanceFeatures, scale) +
         "\n    weights: " + list(num_weights, "0.1") + "\n";
}

TEST(Config, ListsOfNumbersReadBackAsTheSame) {
  const std::string yaml = "detector:\n  colour_model: appearance\n  appearance:\n    bias: 2\n" +
                           appearance_of(vision::kNumAppearanceFeatures);
  const Config config = parse_config(yaml, "rig.yaml");
  EXPECT_EQ(config.detector.colour_model, detection::ColourModel::kAppearance);
  EXPECT_EQ(config.detector.appearance.mean,
            std::vector<double>(vision::kNumAppearanceFeatures, -1.25));
  EXPECT_THAT(print_config(config), HasSubstr("    weights: [0.1, 0.1, "));
  const Config again = parse_config(print_config(config), "printed");
  EXPECT_EQ(again.detector.appearance.scale, config.detector.appearance.scale);
  EXPECT_EQ(effective_config(again), effective_config(config));
  Config other = config;
  other.detector.appearance.weights.back() += 1e-15;
  EXPECT_NE(config_hash(other), config_hash(config));
}

TEST(Config, RefusesListsThatDoNotFit) {
  const std::string head = "detector:\n  appearance:\n";
  EXPECT_THAT(problems_of(head + appearance_of(vision::kNumAppearanceFeatures - 1)),
              ElementsAre(HasSubstr("rig.yaml:5: detector.appearance.weights = (a list): mean, "
                                    "scale and weights must have one number per feature")));
  EXPECT_THAT(problems_of(head + appearance_of(0)), ElementsAre(HasSubstr("one number per")));
  EXPECT_THAT(problems_of(head + "    mean: 7\n"),
              ElementsAre(HasSubstr("rig.yaml:3: detector.appearance.mean = 7: must be a list")));
  EXPECT_THAT(problems_of(head + "    mean: [1, two]\n"),
              Contains(HasSubstr("detector.appearance.mean[1] = two: must be a number")));
  const auto bad_scale = problems_of(head + appearance_of(vision::kNumAppearanceFeatures, "0"));
  EXPECT_EQ(bad_scale.size(), vision::kNumAppearanceFeatures);
  std::string endless = "[0";
  for (int i = 0; i < 5000; ++i) endless += ",0";
  EXPECT_THAT(problems_of(head + "    mean: " + endless + "]\n"),
              ElementsAre(HasSubstr("at most 4096")));
  EXPECT_THAT(problems_of(head + "    version: 77\n"), ElementsAre(HasSubstr("version = 77")));
  EXPECT_THAT(
      problems_of(head + "    version: 1\n" + appearance_of(vision::kNumAppearanceFeatures)),
      ElementsAre(HasSubstr("learnt with other features; run `orchard calibrate trunks` again")));
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

TEST(Config, TheHashDoesNotDependOnTheNetwork) {
  Config config;
  config.lcm.url = "udpm://239.255.76.67:7700?ttl=1";
  EXPECT_EQ(config_hash(config), config_hash(Config{}));
}

TEST(Config, AFileThatIsTooLargeForOneIsRefused) {
  const std::string path = ::testing::TempDir() + "orchard_large.yaml";
  std::ofstream(path) << std::string(1 << 20, '#');
  EXPECT_NO_THROW(load_config(path)) << "a comment of 1 MiB";
  std::ofstream(path) << std::string((1 << 20) + 1, '#');
  for (const std::string& file : {path, std::string("/dev/zero")}) {
    try {
      load_config(file);
      FAIL() << file;
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.problems(), ElementsAre(HasSubstr("larger than 1 MiB")));
    }
  }
  std::filesystem::remove(path);
  for (const std::string& file : {path, ::testing::TempDir()}) {  // a missing file, a folder
    try {
      load_config(file);
      FAIL() << file;
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), HasSubstr(file));
    }
  }
}

/// A key of a printed configuration.
struct PrintedKey {
  std::string section;  ///< with a dot at its end
  std::string name, value;
  bool is_expert = false;
};

std::vector<PrintedKey> keys_of(const std::string& printed) {
  std::vector<PrintedKey> keys;
  std::vector<std::string> sections;
  std::istringstream text(printed);
  for (std::string line; std::getline(text, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    const std::size_t colon = line.find(':');
    const std::string name = line.substr(indent, colon - indent);
    sections.resize(indent / 2);
    if (colon + 1 == line.size() || line.compare(colon, 4, ":  #") == 0) {
      sections.push_back(name);
      continue;
    }
    PrintedKey key{"", name, line.substr(colon + 2), line.find("  # expert: ") != line.npos};
    for (const std::string& section : sections) key.section += section + ".";
    keys.push_back(key);
  }
  return keys;
}

TEST(ConfigLevels, AUserIsShownAtMostSixtyKeysBesideDriversAndSimulation) {
  int num_shown = 0;
  for (const PrintedKey& key : keys_of(print_config(Config(), PrintedKeys::kUser))) {
    EXPECT_FALSE(key.is_expert) << key.section << key.name;
    num_shown += key.section.rfind("drivers.", 0) != 0 && key.section.rfind("simulation.", 0) != 0;
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

struct Crossed {
  const char* yaml;     ///< on one line; every value within its own range
  const char* problem;  ///< part of the one sentence that must come of it
};

constexpr Crossed kCrossed[] = {
    {"detector: {segmentation: {range_min_m: 5, range_max_m: 4}}",
     "range_min_m = 5: must be below"},
    {"detector: {segmentation: {reflector: only}}",
     "reflectivity_min = (default): must be above 0"},
    {"detector: {segmentation: {width_max_m: 0.2}, width: {mean_m: 0.2}}",
     "segmentation.width_max_m"},
    {"detector: {edges: {canny_low: 200, canny_high: 100}}", "canny_low = 200: must be below"},
    {"detector: {pairing_tolerance_s: 0.3}", "pairing_tolerance_s = 0.3: must not be above image"},
    {"detector: {decision: probability}", "decision = probability: probability needs"},
    {"detector: {colour_model: appearance}", "colour_model = appearance: needs a learnt"},
    {"detector: {probability: {enabled: true}}", "enabled = true: needs weights"},
    {"pose: {mode: prior_map}", "mode = prior_map: needs pose.prior_map.map_file"},
    {"pose: {scan_motion: {range_min_m: 40}}", "range_min_m = 40: must be below range_max_m"},
    {"pose: {gnss: {datum: [95, 0, 0]}}", "latitude"},
    {"pose: {gnss: {datum: [0, 200, 0]}}", "longitude"},
    {"pose: {prior_map: {detection_range_m: 20}}", "must not be above observation_range_max_m"},
    {"mapper: {merge_m: 0.7}", "mapper.merge_m = 0.7: must not be above twice gate_m"},
    {"mapper: {pose_gap_max_s: 0.1}",
     "deskew_pose_gap_max_s = (default): must not be above pose_gap"},
    {"simulation: {scanner: {range_min_m: 6}}", "range_min_m = 6: must be below range_max_m"},
    {"simulation: {orchard: {bark_hue_min_deg: 90}}", "bark_hue_min_deg = 90"},
    {"simulation: {orchard: {bark_saturation_min: 0.9}}", "bark_saturation_min = 0.9"},
    {"simulation: {orchard: {bark_value_min: 0.9}}", "bark_value_min = 0.9"},
    {"simulation: {orchard: {start_anywhere: true}}", "start_anywhere = true: needs laps"},
};

TEST(ConfigLimits, CrossedOnesAreRefusedWhereTheyStand) {
  for (const Crossed& crossed : kCrossed) {
    EXPECT_THAT(problems_of(crossed.yaml), ElementsAre(HasSubstr(crossed.problem))) << crossed.yaml;
  }
}

/// Every key of a printed configuration whose name holds _min where another one of its section
/// holds _max: set beyond the maximum, it is refused. Hues alone are circular.
TEST(ConfigLimits, NoMinimumMayPassItsMaximum) {
  const std::vector<PrintedKey> keys = keys_of(effective_config(Config()));
  int num_pairs = 0;
  for (const PrintedKey& key : keys) {
    const std::size_t at = key.name.find("_min");
    if (at == std::string::npos || key.section + key.name == "detector.colour.hue_min_deg")
      continue;
    const std::string other = key.name.substr(0, at) + "_max" + key.name.substr(at + 4);
    for (const PrintedKey& most : keys) {
      if (most.section != key.section || most.name != other) continue;
      std::string open, close;
      std::istringstream names(key.section);
      for (std::string name; std::getline(names, name, '.');) open += name + ": {", close += "}";
      const double beyond = std::stod(most.value) * 1.01;
      EXPECT_THAT(problems_of(open + key.name + ": " + std::to_string(beyond) + close),
                  ElementsAre(HasSubstr(key.section + key.name)));
      ++num_pairs;
    }
  }
  EXPECT_GE(num_pairs, 6);
}

TEST(ConfigLimits, OrderInTheFileDoesNotMatter) {
  EXPECT_THAT(problems_of("detector: {pairing_tolerance_s: 0.3, image_wait_s: 0.4}"), IsEmpty());
  EXPECT_THAT(problems_of("detector: {image_wait_s: 0.4, pairing_tolerance_s: 0.3}"), IsEmpty());
  EXPECT_THAT(problems_of("mapper: {merge_m: 0.7, gate_m: 0.5}"), IsEmpty());
}

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
