// SPDX-License-Identifier: BSD-3-Clause
// evaluate_detections MAP_DIR|DERIVED_LOG... --observations CSV...: compares detections with the
// true observations of a simulation: precision, recall, F1 and the calibration of probabilities, as
// JSON.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "experiments/detections/detection_evaluation.hpp"
#include "io/file_error.hpp"
#include "io/map/map_folder.hpp"
#include "io/recording/truth_csv.hpp"
#include "worlds/observation_csv.hpp"

namespace orchard {
namespace {

namespace fs = std::filesystem;
using evaluation::ObservationPair;

struct Options {
  std::vector<std::string> paths;              ///< map folders or logs with detections
  std::vector<std::string> observation_paths;  ///< truth of each one's scans, in the same order
  std::vector<std::string> truth_paths;  ///< true objects, one file per path, for the landmarks
  evaluation::DetectionRules rules;
  bool without_picture = false;  ///< also count objects outside the picture
};

/// Observations of all recordings, and the landmarks of those with a truth.
struct Material {
  std::vector<ObservationPair> observations;
  std::vector<std::string> names;
  int num_scans = 0;
  bool has_landmarks = false;
  evaluation::LandmarkEvaluation landmarks;
  std::vector<evaluation::Forecast> forecasts;
};

void check_counts(const Options& options) {
  if (options.observation_paths.size() != options.paths.size()) {
    throw io::FileError("there are " + std::to_string(options.paths.size()) + " recordings and " +
                        std::to_string(options.observation_paths.size()) +
                        " observation files; give one --observations per recording, in order");
  }
  if (!options.truth_paths.empty() && options.truth_paths.size() != options.paths.size()) {
    throw io::FileError("there are " + std::to_string(options.paths.size()) + " recordings and " +
                        std::to_string(options.truth_paths.size()) +
                        " truth files; give one --truth per recording, in order, or none");
  }
}

void add_landmarks(const Options& options, std::size_t i,
                   const std::vector<ObservationPair>& observations, Material& material) {
  const std::string& path = options.paths[i];
  if (!fs::is_directory(path)) {
    throw io::FileError(path +
                        " is not a map folder; with --truth give map folders, to evaluate the "
                        "landmarks of map.csv");
  }
  const auto truth = io::read_truth_csv(options.truth_paths[i]);
  const auto landmarks = io::read_map_csv((fs::path(path) / "map.csv").string());
  const auto result = evaluation::evaluate_landmarks(
      landmarks, truth, evaluation::was_observed(observations, truth.size(), options.rules),
      options.rules.gate_m, &material.forecasts);
  material.has_landmarks = true;
  material.landmarks.counts += result.counts;
  material.landmarks.num_trees += result.num_trees;
  if (options.paths.size() == 1) material.landmarks.trees = result.trees;
}

void add_recording(const Options& options, std::size_t i, Material& material) {
  const auto messages = cli::read_detections(options.paths[i]);
  const auto truth = io::read_observation_csv(options.observation_paths[i]);
  evaluation::ObservationPairs found =
      evaluation::pair_observations(messages, truth, static_cast<int>(i), {options.rules.gate_m});
  if (found.num_scans == 0) {
    throw io::FileError(options.observation_paths[i] + " has no scan in common with " +
                        options.paths[i] +
                        ": no time stamp is equal; give the CSV that true_observations wrote "
                        "for that log");
  }
  if (found.num_without_truth > 0) {
    std::fprintf(
        stderr, "evaluate_detections: warning: %s: %d scans with detections are missing in %s\n",
        options.paths[i].c_str(), found.num_without_truth, options.observation_paths[i].c_str());
  }
  if (!options.truth_paths.empty()) add_landmarks(options, i, found.pairs, material);
  material.names.push_back(fs::path(options.paths[i]).filename().string());
  material.num_scans += found.num_scans;
  material.observations.insert(material.observations.end(),
                               std::make_move_iterator(found.pairs.begin()),
                               std::make_move_iterator(found.pairs.end()));
}

int evaluate(Options options) {
  options.rules.in_picture = !options.without_picture;
  check_counts(options);
  Material material;
  for (std::size_t i = 0; i < options.paths.size(); ++i) add_recording(options, i, material);
  evaluation::DetectionEvaluation result =
      evaluation::evaluate_detections(material.observations, material.names, options.rules);
  result.num_scans = material.num_scans;
  if (material.has_landmarks) {
    material.landmarks.reliability = evaluation::reliability(material.forecasts);
    result.landmarks = material.landmarks;
  }
  std::fputs(detection_json(result).c_str(), stdout);
  return bus::kExitOk;
}

/// Adds an option that must lie in a range; its help names the default.
template <class Value>
void add_limit(CLI::App& app, const char* name, Value& value, Value lo, Value hi,
               const char* what) {
  app.add_option(name, value, what)->check(CLI::Range(lo, hi))->capture_default_str();
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  orchard::Options o;
  CLI::App app{"Compares detections with the true observations of a simulation; JSON, in metres.",
               "evaluate_detections"};
  app.add_option("recordings", o.paths, "map folders with derived.lcm, or logs with DETECTIONS")
      ->required();
  app.add_option("--observations", o.observation_paths,
                 "true observations (true_observations), one file per recording")
      ->required();
  app.add_option("--truth", o.truth_paths,
                 "true objects, one file per recording: also evaluate the landmarks");
  orchard::add_limit(app, "--range", o.rules.range_max_m, 0.1, 100.0,
                     "evaluate only objects nearer than this [m]");
  orchard::add_limit(app, "--min-beams", o.rules.num_beams_min, 1, 10000,
                     "evaluate only objects hit by at least this many beams");
  orchard::add_limit(app, "--hidden", o.rules.hidden_max, 0.0, 1.0,
                     "evaluate only objects with at most this fraction occluded");
  orchard::add_limit(app, "--gate", o.rules.gate_m, 0.001, 10.0,
                     "max distance of a detection from its object [m]");
  app.add_flag("--without-picture", o.without_picture,
               "also evaluate objects that are not entirely in a picture");
  CLI11_PARSE(app, argc, argv);
  try {
    return orchard::evaluate(o);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "evaluate_detections: %s\n", error.what());
    return orchard::bus::kExitInput;
  }
}
