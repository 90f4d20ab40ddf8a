// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config_edit.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "io/config/config.hpp"

namespace orchard::io {
namespace {

const std::vector<ConfigValue> kWidth{{"detector.width.mean_m", "0.12"},
                                      {"detector.width.sd_m", "0.015"}};

TEST(ConfigEdit, ReplacesValuesAndKeepsTheRest) {
  const std::string before =
      "# my rig\n"
      "detector:\n"
      "  # trunks\n"
      "  width:\n"
      "    mean_m: 0.09   # tubes\n"
      "    sd_m:   0.01\n"
      "\n"
      "  tree_threshold: 0.6  # keep\n"
      "laser: {mount_x_m: 0.1, range_sd_m: 0.02}\n";
  const std::string after =
      "# my rig\n"
      "detector:\n"
      "  # trunks\n"
      "  width:\n"
      "    mean_m: 0.12   # tubes\n"
      "    sd_m:   0.015\n"
      "\n"
      "  tree_threshold: 0.6  # keep\n"
      "laser: {mount_x_m: 0.1, range_sd_m: 0.02}\n";
  EXPECT_EQ(edit_config(before, "rig.yaml", kWidth), after);
}

TEST(ConfigEdit, ReplacesAListOverSeveralLines) {
  const std::string before =
      "camera:\n"
      "  fc_px: [200,  # focal lengths\n"
      "          201]  # measured\n"
      "  cc_px: [160, 120]\n";
  EXPECT_EQ(edit_config(before, "rig.yaml", {{"camera.fc_px", "[300, 301]"}}),
            "camera:\n  fc_px: [300, 301]  # measured\n  cc_px: [160, 120]\n");
}

TEST(ConfigEdit, InsertsDeepIntoSectionsInBraces) {
  const std::vector<ConfigValue> bias{{"detector.appearance.bias", "2.5"}};
  EXPECT_EQ(edit_config("{}", "rig.yaml", bias), "{detector: {appearance: {bias: 2.5}}}\n");
  EXPECT_EQ(edit_config("detector: {tree_threshold: 0.5}", "rig.yaml", bias),
            "detector: {appearance: {bias: 2.5}, tree_threshold: 0.5}\n");
}

TEST(ConfigEdit, InsertsMissingKeysAndSections) {
  EXPECT_EQ(edit_config("", "rig.yaml", kWidth),
            "detector:\n  width:\n    mean_m: 0.12\n    sd_m: 0.015\n");
  EXPECT_EQ(edit_config("detector:\n    tree_threshold: 0.5\nlcm:\n", "rig.yaml", kWidth),
            "detector:\n    width:\n      mean_m: 0.12\n      sd_m: 0.015\n"
            "    tree_threshold: 0.5\nlcm:\n");
}

TEST(ConfigEdit, EditsInlineSections) {
  EXPECT_EQ(edit_config("detector: {width: {mean_m: 0.09, sd_m: 0.01}, tree_threshold: 0.5}\n",
                        "rig.yaml", kWidth),
            "detector: {width: {mean_m: 0.12, sd_m: 0.015}, tree_threshold: 0.5}\n");
  const std::string inserted = edit_config("detector: {tree_threshold: 0.5}\n", "rig.yaml", kWidth);
  EXPECT_EQ(parse_config(inserted, "rig.yaml").detector.width.mean_m, 0.12);
  EXPECT_EQ(parse_config(inserted, "rig.yaml").detector.tree_threshold, 0.5);
}

TEST(ConfigEdit, FillsKeysWithoutAValue) {
  const std::string text = edit_config("detector:\n  width:\n  colour:\n", "rig.yaml", kWidth);
  EXPECT_EQ(parse_config(text, "rig.yaml").detector.width.sd_m, 0.015);
}

TEST(ConfigEdit, TheNoteStandsAboveAndIsReplacedNextTime) {
  const std::string once = edit_config("detector:\n  width:\n    mean_m: 0.09\n", "rig.yaml",
                                       {kWidth[0]}, "calibrated", "20 trunks");
  EXPECT_EQ(once, "detector:\n  width:\n    # calibrated: 20 trunks\n    mean_m: 0.12\n");
  EXPECT_EQ(edit_config(once, "rig.yaml", {kWidth[0]}, "calibrated", "25 trunks"),
            "detector:\n  width:\n    # calibrated: 25 trunks\n    mean_m: 0.12\n");
}

TEST(ConfigEdit, KeepsWhatStoodInTheFileItWrites) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                       ("orchard_config_edit_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto write = [](const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path) << text;
  };
  const auto read = [](const std::filesystem::path& path) {
    std::ifstream file(path);
    return std::string((std::istreambuf_iterator<char>(file)), {});
  };
  const auto rig = folder / "rig.yaml", other = folder / "other.yaml";
  write(rig, "detector:\n  width:\n    mean_m: 0.09\n");
  write(other, "lcm:\n");
  edit_config_file(rig.string(), other.string(), kWidth, "test", "note");
  EXPECT_EQ(read(other.string() + ".bak"), "lcm:\n");
  EXPECT_EQ(read(rig), "detector:\n  width:\n    mean_m: 0.09\n");
  EXPECT_EQ(load_config(other.string()).detector.width.mean_m, 0.12);
  // nothing is touched when the result would be no good
  EXPECT_THROW(edit_config_file(rig.string(), other.string(), {{"detector.width.mean_m", "-3"}},
                                "test", "note"),
               ConfigError);
  EXPECT_EQ(load_config(other.string()).detector.width.mean_m, 0.12);
  EXPECT_EQ(read(other.string() + ".bak"), "lcm:\n");
  std::filesystem::remove_all(folder);
}

TEST(ConfigEdit, RefusesWhatWouldNotLoad) {
  EXPECT_THROW(edit_config("detector:\n  wdith: 3\n", "rig.yaml", kWidth), ConfigError);
  EXPECT_THROW(edit_config("", "rig.yaml", {{"detector.width.mean_m", "-3"}}), ConfigError);
  EXPECT_THROW(edit_config("", "rig.yaml", {{"detector.width.nonsense", "3"}}), ConfigError);
}

TEST(ConfigEdit, EveryPrintedKeyCanBeEdited) {
  const std::string all = print_config(Config{});
  const std::string edited = edit_config(all, "rig.yaml",
                                         {{"detector.width.mean_m", "0.2"},
                                          {"detector.colour.hue_max_deg", "77"},
                                          {"laser.mount_x_m", "1"}});
  Config config = parse_config(edited, "rig.yaml");
  EXPECT_EQ(config.detector.width.mean_m, 0.2);
  EXPECT_EQ(config.detector.colour.hue_max_deg, 77.0);
  EXPECT_EQ(config.laser.mount_x_m, 1.0);
}

}  // namespace
}  // namespace orchard::io
