// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibration_run.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>

#include "bus/process/process.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "calibration/trunks/probability_learner.hpp"
#include "evaluation/reliability.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/progress_bar.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

constexpr std::size_t kMaxNumbers = 10000;

/// Parses a text that is entirely a number; -1 otherwise.
int number_of(const std::string& text) {
  int number = -1;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  return result.ec == std::errc() && result.ptr == end && !text.empty() ? number : -1;
}

}  // namespace

std::vector<int> parse_number_list(const std::string& text, const std::string& what) {
  const auto refuse = [&](const std::string& part) {
    throw io::FileError(what + " " + text + ": \"" + part +
                        "\" is neither a number nor a range such as 9-20");
  };
  std::set<int> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const int first = number_of(part.substr(0, dash));
    const int last = dash == std::string::npos ? first : number_of(part.substr(dash + 1));
    if (first < 0 || last < first) refuse(part);
    if (static_cast<std::size_t>(last - first) >= kMaxNumbers) refuse(part);
    for (int number = first; number <= last; ++number) numbers.insert(number);
    if (numbers.size() > kMaxNumbers) refuse(part);
  }
  if (numbers.empty()) refuse(text);
  return {numbers.begin(), numbers.end()};
}

std::vector<int> picked_ids(const std::string& text,
                            const std::vector<mapping::Landmark>& landmarks,
                            const std::string& map_path) {
  std::vector<int> ids = parse_number_list(text, "--ids");
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
          {"detector.probability.judged_tree", fixed_list(fit.config.judged_tree, 4)},
          {"detector.probability.judged_object", fixed_list(fit.config.judged_object, 4)},
          {"detector.probability.laser_tree", fixed_list(fit.config.laser_tree, 4)},
          {"detector.probability.laser_object", fixed_list(fit.config.laser_object, 4)},
          {"mapper.evidence_prior", fixed_text(fit.prior, 3)},
          {"mapper.evidence_base_rate", fixed_text(fit.base_rate, 3)},
          {"mapper.evidence_correlation", fixed_text(fit.correlation, 3)}};
}

namespace {

using calibration::Outcome;
using calibration::ProbabilityFit;
using calibration::ProbabilitySample;

constexpr const char* kFeatureNames[] = {"1",
                                         "width z",
                                         "width z^2 / 5",
                                         "range (m)",
                                         "log(beams / 10)",
                                         "hidden sides",
                                         "colour log odds",
                                         "colour is 0",
                                         "roc_edges",
                                         "roc_edges is 0"};

/// How the calibration error was measured.
const char* validation_text(const ProbabilityFit& fit) {
  switch (fit.left_out) {
    case calibration::LeftOut::kRecordings:
      return "cross-validated over recordings";
    case calibration::LeftOut::kObjects:
      return "cross-validated over the objects of one recording";
    case calibration::LeftOut::kNothing:
      break;
  }
  return "on the training data, which has only one tree";
}

void print_weights(const char* title, const calibration::FittedWeights& tree,
                   const calibration::FittedWeights& object) {
  std::printf("%-18s %9s %7s   %9s %7s\n", title, "tree", "se", "object", "se");
  for (std::size_t i = 0; i < tree.values.size(); ++i) {
    std::printf("  %-16s %9.3f %7.3f   %9.3f %7.3f\n", kFeatureNames[i], tree.values[i],
                tree.standard_errors[i], object.values[i], object.standard_errors[i]);
  }
}

double left_out_error(const std::vector<ProbabilitySample>& samples, const ProbabilityFit& fit) {
  std::vector<evaluation::Forecast> forecasts;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (fit.left_out_tree[i] < 0.0) continue;
    forecasts.push_back(
        {std::min(1.0, fit.left_out_tree[i]), samples[i].outcome == Outcome::kTree});
  }
  return evaluation::reliability(forecasts).expected_calibration_error;
}

void print_fit(const ProbabilityFit& fit, double error) {
  print_weights("judged by camera", fit.judged_tree, fit.judged_object);
  print_weights("laser only", fit.laser_tree, fit.laser_object);
  std::printf(
      "%d observations judged by the camera, %d by the laser only, of %d objects in %d recordings\n"
      "%s: expected calibration error %.4f, log loss %.4f\n"
      "landmarks: fraction of trees %.3f, fraction of trees among observations %.3f, correlation "
      "of observations %.3f\n",
      fit.num_judged, fit.num_laser, fit.num_objects, fit.num_recordings, validation_text(fit),
      error, fit.log_loss, fit.prior, fit.base_rate, fit.correlation);
}

/// The keys that a person still has to set before the probabilities judge.
std::string to_set(const io::Config& config) {
  std::string keys;
  if (config.detector.decision != detection::Decision::kProbability) {
    keys = "detector.decision: probability";
  }
  if (config.mapper.evidence != mapping::Evidence::kProbability) {
    keys += (keys.empty() ? "" : " and ") + std::string("mapper.evidence: probability");
  }
  return keys.empty() ? "" : "; to judge by these probabilities, set " + keys + " there";
}

}  // namespace

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
               const std::string& note, bool quiet, const std::string& more) {
  const std::string& out = out_path.empty() ? config_path : out_path;
  std::string line = note;  // file names may contain line breaks; a comment is one line
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  io::edit_config_file(config_path, out, values, command, line);
  if (!quiet) std::printf("written to %s%s\n", out.c_str(), more.c_str());
}

int write_probability(const CalibrateProbabilityOptions& options, const io::Config& config,
                      const std::vector<ProbabilitySample>& samples) {
  calibration::ProbabilityLearnOptions rules;
  rules.width_mean_m = config.detector.width.mean_m;
  const ProbabilityFit fit = naming(options.log_paths.front(),
                                    [&] { return calibration::learn_probability(samples, rules); });
  const double error = left_out_error(samples, fit);
  if (!options.quiet) print_fit(fit, error);

  const std::string note = std::to_string(fit.num_judged + fit.num_laser) + " observations in " +
                           std::to_string(fit.num_recordings) + " recordings, from " +
                           logs_text(options.log_paths) + "; calibration error " +
                           fixed_text(error, 4) + " (" + validation_text(fit) + ")";
  write_rig(options.config_path, options.out_path, probability_values(fit),
            "orchard calibrate probability", note, options.quiet, to_set(config));
  return bus::kExitOk;
}

}  // namespace orchard::cli
