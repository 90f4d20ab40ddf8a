// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/appearance_values.hpp"

#include <fmt/core.h>
#include <string>

namespace orchard::cli {
namespace {

std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string list(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) text += (text.size() > 1 ? ", " : "") + number(value);
  return text + "]";
}

}  // namespace

std::vector<io::ConfigValue> appearance_values(const vision::AppearanceConfig& config) {
  return {{"detector.colour_model", "appearance"},
          {"detector.appearance.version", std::to_string(config.version)},
          {"detector.appearance.confidence_min", number(config.confidence_min)},
          {"detector.appearance.bias", number(config.bias)},
          {"detector.appearance.mean", list(config.mean)},
          {"detector.appearance.scale", list(config.scale)},
          {"detector.appearance.weights", list(config.weights)},
          {"detector.appearance.squares", list(config.squares)}};
}

}  // namespace orchard::cli
