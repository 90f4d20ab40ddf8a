// SPDX-License-Identifier: BSD-3-Clause
// learn_probability LOG... --observations CSV... --config IN --out OUT: calibrates the
// probabilities of tree and object from simulated drives with their true observations, as `orchard
// calibrate trunks` does from the trunks that it finds.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "experiments/detections/reliability.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "worlds/observation_csv.hpp"
#include "worlds/observation_pair.hpp"

namespace orchard {
namespace {

using calibration::Outcome;
using calibration::ProbabilitySample;

Outcome outcome_of(const evaluation::ObservationPair& observation) {
  if (!observation.truth) return Outcome::kNeither;
  return observation.is_tree() ? Outcome::kTree : Outcome::kObject;
}

/// Adds a sample for each detection of a log, with its true object.
void add_samples(const std::string& log_path, const std::string& observation_path, int recording,
                 const io::Config& config, bool quiet, std::vector<ProbabilitySample>& samples) {
  const auto messages = cli::detect_log(log_path, config, !quiet);
  const auto found = evaluation::pair_observations(
      messages, io::read_observation_csv(observation_path), recording);
  if (found.num_scans == 0) {
    throw io::FileError(observation_path + " has no scan in common with " + log_path +
                        ": no time stamp is equal; give the file of the same simulation");
  }
  for (const evaluation::ObservationPair& observation : found.pairs) {
    if (!observation.detection) continue;
    samples.push_back({*observation.detection, outcome_of(observation), recording,
                       observation.truth ? observation.truth->object : -1});
  }
}

struct Options {
  std::vector<std::string> log_paths, observation_paths;
  std::string config_path, out_path;
  bool quiet = false;
};

int learn(const Options& options) {
  const io::Config config = io::load_config(options.config_path);
  if (options.observation_paths.size() != options.log_paths.size()) {
    throw io::FileError("give one --observations per log, in order");
  }
  std::vector<ProbabilitySample> samples;
  for (std::size_t i = 0; i < options.log_paths.size(); ++i) {
    add_samples(options.log_paths[i], options.observation_paths[i], static_cast<int>(i), config,
                options.quiet, samples);
  }
  calibration::ProbabilityLearnOptions rules;
  rules.width_mean_m = config.detector.width.mean_m;
  const auto fit = calibration::learn_probability(samples, rules);
  std::vector<evaluation::Forecast> forecasts;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (fit.left_out_tree[i] < 0.0) continue;
    forecasts.push_back(
        {std::min(1.0, fit.left_out_tree[i]), samples[i].outcome == Outcome::kTree});
  }
  const double error = evaluation::reliability(forecasts).expected_calibration_error;
  cli::write_rig(
      options.config_path, options.out_path, cli::probability_values(fit), "learn_probability",
      std::to_string(samples.size()) + " observations in " + std::to_string(fit.num_recordings) +
          " recordings, from " + cli::logs_text(options.log_paths) + "; calibration error " +
          fixed_text(error, 4),
      options.quiet);
  return bus::kExitOk;
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  orchard::Options o;
  CLI::App app{"Calibrates probabilities from simulated drives.", "learn_probability"};
  app.add_option("logs", o.log_paths, "logs of drives, or their derived logs")->required();
  app.add_option("--observations", o.observation_paths,
                 "true observations (true_observations), one file per log")
      ->required();
  app.add_option("--config", o.config_path, "rig of the recordings")->required();
  app.add_option("--out", o.out_path, "YAML to write [the rig, the old one kept as .bak]");
  app.add_flag("--quiet", o.quiet, "print only warnings and errors");
  CLI11_PARSE(app, argc, argv);
  try {
    return orchard::learn(o);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "learn_probability: %s\n", error.what());
    return orchard::bus::kExitInput;
  }
}
