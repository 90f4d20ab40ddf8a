// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace orchard::io {
namespace {

using ::testing::Contains;
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

TEST(Config, AnEmptyListIsPrintedAndReadBack) {
  EXPECT_THAT(print_config(Config()), HasSubstr("    weights: []"));
  EXPECT_TRUE(parse_config(print_config(Config()), "printed").detector.appearance.weights.empty());
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

TEST(Config, TheAppearanceModelMustBeLearntBeforeItIsUsed) {
  EXPECT_THAT(problems_of("detector:\n  colour_model: appearance\n"),
              ElementsAre(HasSubstr("rig.yaml:2: detector.colour_model = appearance: needs a "
                                    "learnt detector.appearance")));
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
  EXPECT_THROW(load_config(path), ConfigError);
  EXPECT_THROW(load_config(::testing::TempDir()), ConfigError) << "a folder";
}

}  // namespace
}  // namespace orchard::io
