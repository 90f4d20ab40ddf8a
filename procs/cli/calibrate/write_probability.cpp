// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/write_probability.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "bus/process/process.hpp"
#include "calibration/trunks/probability_learner.hpp"
#include "cli/calibrate/probability_values.hpp"
#include "evaluation/reliability.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
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

int write_probability(const CalibrateProbabilityOptions& options, const io::Config& config,
                      const std::vector<ProbabilitySample>& samples) {
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
