// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate_probability.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "bus/process/process.hpp"
#include "calibration/trunks/probability_learner.hpp"
#include "cli/calibrate/map_samples.hpp"
#include "cli/calibrate/probability_values.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "evaluation/detections/observation_pair.hpp"
#include "evaluation/detections/reliability.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/recording/observation_csv.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
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

Outcome outcome_of(const evaluation::ObservationPair& observation) {
  if (!observation.truth) return Outcome::kNeither;
  return observation.is_tree() ? Outcome::kTree : Outcome::kObject;
}

/// A sample for each detection of a log, with its true object.
std::vector<ProbabilitySample> true_samples(const CalibrateProbabilityOptions& options,
                                            const std::vector<detection::Detections>& messages,
                                            std::size_t i) {
  const int recording = static_cast<int>(i);
  const auto truth = io::read_observation_csv(options.observation_paths[i]);
  const auto found = evaluation::pair_observations(messages, truth, recording);
  if (found.num_scans == 0) {
    throw io::FileError(
        options.observation_paths[i] + " has no scan in common with " + options.log_paths[i] +
        ": no time stamp is equal; give the file that was written together with this log");
  }
  std::vector<ProbabilitySample> samples;
  for (const evaluation::ObservationPair& observation : found.pairs) {
    if (!observation.detection) continue;
    samples.push_back({*observation.detection, outcome_of(observation), recording,
                       observation.truth ? observation.truth->object : -1});
  }
  return samples;
}

std::vector<ProbabilitySample> samples_of(const CalibrateProbabilityOptions& options,
                                          const io::Config& config) {
  const bool has_maps = !options.map_folders.empty();
  const std::size_t num = has_maps ? options.map_folders.size() : options.observation_paths.size();
  if (num != options.log_paths.size()) {
    throw io::FileError("there are " + std::to_string(options.log_paths.size()) + " logs and " +
                        std::to_string(num) +
                        (has_maps ? " maps; give one --map per log, in order"
                                  : " observation files; give one --observations per log, in "
                                    "order"));
  }
  std::vector<ProbabilitySample> samples;
  for (std::size_t i = 0; i < num; ++i) {
    const auto messages = detect_log(options.log_paths[i], config, !options.quiet);
    const auto more = has_maps ? map_samples({options.log_paths[i], options.map_folders[i],
                                              options.ids, static_cast<int>(i)},
                                             messages, config, options.quiet)
                               : true_samples(options, messages, i);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  return samples;
}

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

int run_calibrate_probability(const CalibrateProbabilityOptions& options) {
  const io::Config config = io::load_config(options.config_path);
  const std::vector<ProbabilitySample> samples = samples_of(options, config);
  calibration::ProbabilityLearnOptions rules;
  rules.width_mean_m = config.detector.width.mean_m;
  ProbabilityFit fit;
  try {
    fit = calibration::learn_probability(samples, rules);
  } catch (const std::runtime_error& error) {
    throw io::FileError(options.log_paths.front() + ": " + error.what());
  }
  const double error = left_out_error(samples, fit);
  if (!options.quiet) print_fit(fit, error);

  const std::string out = options.out_path.empty() ? options.config_path : options.out_path;
  const std::string note = std::to_string(fit.num_judged + fit.num_laser) + " observations in " +
                           std::to_string(fit.num_recordings) + " recordings, from " +
                           std::filesystem::path(options.log_paths.front()).filename().string() +
                           "; calibration error " + fixed_text(error, 4) + " (" +
                           validation_text(fit) + ")";
  io::edit_config_file(options.config_path, out, probability_values(fit),
                       "orchard calibrate probability", note);
  if (!options.quiet) std::printf("written to %s%s\n", out.c_str(), to_set(config).c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
