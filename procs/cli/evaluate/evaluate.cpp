// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "bus/process/process.hpp"
#include "evaluation/map_evaluation.hpp"
#include "evaluation/trajectory_evaluation.hpp"
#include "geometry/angles.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/map/map_folder.hpp"
#include "io/recording/truth_csv.hpp"

namespace orchard::cli {
namespace {

/// Evaluates trajectory.csv beside the map against the true poses.
evaluation::TrajectoryEvaluation judge_trajectory(const EvaluateOptions& options) {
  const std::filesystem::path map_csv = io::file_in(options.map_path, "map.csv");
  const std::string path = (map_csv.parent_path() / "trajectory.csv").string();
  evaluation::TrajectoryRules rules;
  if (options.align) rules.alignment = evaluation::Alignment::kRigid;
  return evaluation::evaluate_trajectory(io::read_track_csv(path),
                                         io::read_track_csv(options.poses_path), rules);
}

/// Prints the evaluation as one line.
void print_trajectory(const evaluation::TrajectoryEvaluation& evaluation, bool aligned) {
  constexpr double kDegPerRad = 180.0 / geometry::kPi;
  std::printf(
      "trajectory%s: error RMS %.2f mm and %.3f deg, max %.2f mm and %.3f deg, at %zu poses (%d "
      "more are outside the time of the truth)\n",
      aligned ? ", aligned separately" : "", 1e3 * evaluation.position_m.rmse,
      kDegPerRad * evaluation.yaw_rad.rmse, 1e3 * evaluation.position_m.max,
      kDegPerRad * evaluation.yaw_rad.max, evaluation.compared.size(), evaluation.num_outside);
}

}  // namespace

int run_evaluate(const EvaluateOptions& options) {
  const std::string map_csv = io::file_in(options.map_path, "map.csv");
  const std::vector<mapping::Landmark> landmarks = io::read_map_csv(map_csv);
  const std::vector<simulation::TruthObject> truth = io::read_truth_csv(options.truth_path);
  std::optional<evaluation::TrajectoryEvaluation> trajectory;
  if (!options.poses_path.empty()) trajectory = judge_trajectory(options);
  std::optional<geometry::Pose2> guess;
  if (trajectory && !trajectory->compared.empty()) guess = trajectory->T_truth_estimate;
  const evaluation::MapEvaluation evaluation =
      options.align ? evaluation::evaluate_aligned_map(landmarks, truth, options.gate_m,
                                                       options.search, guess)
                    : evaluation::evaluate_map(landmarks, truth, options.gate_m);
  if (options.json) {
    std::fputs(evaluation_json(evaluation).c_str(), stdout);
  } else {
    std::printf("%s\n%s", paper_tables(evaluation).c_str(), evaluation_summary(evaluation).c_str());
    if (trajectory) print_trajectory(*trajectory, options.align);
  }
  return options.check && !evaluation.perfect() ? bus::kExitRuntime : bus::kExitOk;
}

}  // namespace orchard::cli
