// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/trunk_decision.hpp"

#include <fmt/core.h>
#include <cstdio>
#include <stdexcept>

#include "calibration/trunks/decision_errors.hpp"
#include "calibration/trunks/landmark_outcomes.hpp"
#include "calibration/trunks/object_landmarks.hpp"
#include "cli/calibrate/probability_values.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

std::vector<calibration::ProbabilitySample> samples_of(const TrunkDrives& drives,
                                                       const calibration::TrunkModel& model,
                                                       const io::Config& config, bool quiet) {
  std::vector<calibration::ProbabilitySample> samples;
  for (std::size_t i = 0; i < drives.log_paths.size(); ++i) {
    const int log = static_cast<int>(i);
    const calibration::LandmarkOutcomes outcomes(
        calibration::object_landmarks(model, drives.observations, log), config.mapper);
    const auto found =
        calibration::landmark_samples(detect_log(drives.log_paths[i], config, !quiet),
                                      drives.paths[i], outcomes, config.mapper, log);
    samples.insert(samples.end(), found.samples.begin(), found.samples.end());
  }
  return samples;
}

}  // namespace

std::vector<io::ConfigValue> learn_decision(const TrunkDrives& drives,
                                            const calibration::TrunkModel& model, io::Config learnt,
                                            DecisionChoice choice, bool quiet, std::string& note) {
  if (choice == DecisionChoice::kRoc) return {{"detector.decision", "roc"}};
  learnt.detector.decision = detection::Decision::kRoc;
  learnt.detector.probability = {};
  try {
    const auto samples = samples_of(drives, model, learnt, quiet);
    calibration::ProbabilityLearnOptions rules;
    rules.width_mean_m = learnt.detector.width.mean_m;
    const auto fit = calibration::learn_probability(samples, rules);
    const calibration::DecisionErrors errors = calibration::decision_errors(samples, fit);
    const std::string text = fmt::format(
        "wrong of {} detections: decision: roc {}, probability {} (left-out {})", errors.num,
        errors.roc, errors.probability, drives.log_paths.size() > 1 ? "drives" : "objects");
    if (!quiet) std::printf("%s\n", text.c_str());
    note += "; " + text;
    const bool by_probability =
        choice == DecisionChoice::kProbability || errors.probability < errors.roc;
    // The weights are written in any case: earlier ones belong to another width and colour.
    std::vector<io::ConfigValue> values = probability_values(fit);
    values.push_back({"detector.decision", by_probability ? "probability" : "roc"});
    return values;
  } catch (const std::runtime_error& error) {
    if (choice == DecisionChoice::kProbability) {
      throw io::FileError(drives.log_paths.front() + ": " + error.what());
    }
    if (!quiet) {
      std::printf("detector.decision is unchanged, no probabilities were learnt: %s\n",
                  error.what());
    }
    return {};
  }
}

}  // namespace orchard::cli
