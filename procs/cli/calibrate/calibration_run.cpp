// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibration_run.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>

#include "bus/process/process.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "calibration/trunks/probability_learner.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/progress_bar.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

constexpr std::size_t kMaxNumbers = 10000;

/// Parses a list of ids such as "3,7,9-20" to unique numbers in ascending order. Throws
/// io::FileError for anything else, and for more than 10000 numbers.
std::vector<int> parse_ids(const std::string& text) {
  const auto refuse = [&](const std::string& part) {
    throw io::FileError("--ids " + text + ": \"" + part +
                        "\" is neither a number nor a range such as 9-20");
  };
  std::set<int> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const int first = whole_number(part.substr(0, dash)).value_or(-1);
    const int last =
        dash == std::string::npos ? first : whole_number(part.substr(dash + 1)).value_or(-1);
    if (first < 0 || last < first) refuse(part);
    if (static_cast<std::size_t>(last - first) >= kMaxNumbers) refuse(part);
    for (int number = first; number <= last; ++number) numbers.insert(number);
    if (numbers.size() > kMaxNumbers) refuse(part);
  }
  if (numbers.empty()) refuse(text);
  return {numbers.begin(), numbers.end()};
}

}  // namespace

std::vector<int> picked_ids(const std::string& text,
                            const std::vector<mapping::Landmark>& landmarks,
                            const std::string& map_path) {
  std::vector<int> ids = parse_ids(text);
  std::string missing;
  for (const int id : ids) {
    const bool is_there = std::any_of(landmarks.begin(), landmarks.end(),
                                      [id](const auto& landmark) { return landmark.id == id; });
    if (!is_there) missing += (missing.empty() ? "" : ", ") + std::to_string(id);
  }
  if (missing.empty()) return ids;
  throw io::FileError(map_path + ": no landmark has id " + missing +
                      "; choose ids from the column id of this file");
}

std::vector<io::ConfigValue> appearance_values(const vision::AppearanceConfig& config) {
  const auto number = [](double value) { return fmt::format("{:.6g}", value); };
  const auto list = [](const std::vector<double>& values) {
    return fmt::format("[{:.6g}]", fmt::join(values, ", "));
  };
  return {{"detector.colour_model", "appearance"},
          {"detector.appearance.version", std::to_string(config.version)},
          {"detector.appearance.confidence_min", number(config.confidence_min)},
          {"detector.appearance.bias", number(config.bias)},
          {"detector.appearance.mean", list(config.mean)},
          {"detector.appearance.scale", list(config.scale)},
          {"detector.appearance.weights", list(config.weights)},
          {"detector.appearance.squares", list(config.squares)}};
}

std::vector<io::ConfigValue> probability_values(const calibration::ProbabilityFit& fit) {
  return {{"detector.probability.enabled", "true"},
          {"detector.probability.judged_tree", io::config_numbers(fit.config.judged_tree, 4)},
          {"detector.probability.judged_object", io::config_numbers(fit.config.judged_object, 4)},
          {"detector.probability.laser_tree", io::config_numbers(fit.config.laser_tree, 4)},
          {"detector.probability.laser_object", io::config_numbers(fit.config.laser_object, 4)},
          {"mapper.evidence_prior", fixed_text(fit.prior, 3)},
          {"mapper.evidence_base_rate", fixed_text(fit.base_rate, 3)},
          {"mapper.evidence_correlation", fixed_text(fit.correlation, 3)}};
}

void replay_log(const char* command, const std::string& path, const std::vector<bus::Node*>& nodes,
                bool quiet, std::set<std::string>& said) {
  io::ProgressBar bar("reading logs", !quiet);
  bus::ReplayOptions replay;
  replay.progress = [&](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
  const bus::ReplayReport report = bus::replay_in_process(path, nodes, replay);
  bar.finish();
  for (const std::string& warning : report.warnings) {
    if (!said.insert(warning).second) continue;
    std::fprintf(stderr, "%s: warning: %s\n", command, warning.c_str());
  }
}

std::string logs_text(const std::vector<std::string>& log_paths) {
  const std::string name = std::filesystem::path(log_paths.front()).filename().string();
  if (log_paths.size() == 1) return name;
  return name + " and " + std::to_string(log_paths.size() - 1) + " more";
}

void write_rig(const std::string& config_path, const std::string& out_path,
               const std::vector<io::ConfigValue>& values, const char* command,
               const std::string& note, bool quiet) {
  const std::string& out = out_path.empty() ? config_path : out_path;
  std::string line = note;  // file names may contain line breaks; a comment is one line
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  io::edit_config_file(config_path, out, values, command, line);
  if (!quiet) std::printf("written to %s\n", out.c_str());
}

}  // namespace orchard::cli
