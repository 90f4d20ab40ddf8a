// SPDX-License-Identifier: BSD-3-Clause
// Two keys that constrain each other: a configuration that crosses them is refused, and says so.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/config/config.hpp"

namespace orchard::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> problems_of(const std::string& yaml) {
  try {
    parse_config(yaml, "rig.yaml");
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
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
  std::vector<std::pair<std::string, std::string>> keys;  // path of the section and name
  std::vector<std::string> values;
  std::vector<std::string> sections;
  std::istringstream text(effective_config(Config()));
  for (std::string line; std::getline(text, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    const std::size_t colon = line.find(':');
    sections.resize(indent / 2);
    if (colon + 1 == line.size()) {
      sections.push_back(line.substr(indent, colon - indent));
      continue;
    }
    std::string path;
    for (const std::string& section : sections) path += section + ".";
    keys.emplace_back(path, line.substr(indent, colon - indent));
    values.push_back(line.substr(colon + 2));
  }
  int num_pairs = 0;
  for (const auto& [path, key] : keys) {
    const std::size_t at = key.find("_min");
    if (at == std::string::npos || path + key == "detector.colour.hue_min_deg") continue;
    const std::string other = key.substr(0, at) + "_max" + key.substr(at + 4);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i].first != path || keys[i].second != other) continue;
      std::string open, close;
      std::istringstream names(path);
      for (std::string name; std::getline(names, name, '.');) {
        open += name + ": {";
        close += "}";
      }
      const double beyond = std::stod(values[i]) * 1.01;
      const auto problems = problems_of(open + key + ": " + std::to_string(beyond) + close);
      EXPECT_THAT(problems, ElementsAre(HasSubstr(path + key))) << path << key;
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

}  // namespace
}  // namespace orchard::io
