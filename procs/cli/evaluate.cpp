// SPDX-License-Identifier: BSD-3-Clause
#include "cli/evaluate.hpp"

#include <cstdio>
#include <filesystem>

#include "bus/process.hpp"
#include "evaluation/map_evaluation.hpp"
#include "evaluation/paper_tables.hpp"
#include "evaluation/trajectory_evaluation.hpp"
#include "geometry/angles.hpp"
#include "io/map_folder.hpp"
#include "io/trajectory_csv.hpp"
#include "io/truth_csv.hpp"

namespace orchard::cli {
namespace {

std::string in_folder(const std::string& path, const char* file) {
  return std::filesystem::is_directory(path) ? (std::filesystem::path(path) / file).string() : path;
}

/// trajectory.csv beside the map against the true poses, in a line for a person.
void print_trajectory(const EvaluateOptions& options) {
  const std::string folder = std::filesystem::is_directory(options.map_path)
                                 ? options.map_path
                                 : std::filesystem::path(options.map_path).parent_path().string();
  const std::string path = (std::filesystem::path(folder) / "trajectory.csv").string();
  const evaluation::TrajectoryEvaluation evaluation = evaluation::evaluate_trajectory(
      io::read_trajectory_csv(path), io::read_poses_csv(options.poses_path));
  constexpr double kDegPerRad = 180.0 / geometry::kPi;
  std::printf(
      "trajectory: RMS %.2f mm and %.3f deg, largest %.2f mm and %.3f deg, at %d true poses"
      " (%d outside its time)\n",
      1e3 * evaluation.position_rms_m, kDegPerRad * evaluation.yaw_rms_rad,
      1e3 * evaluation.position_max_m, kDegPerRad * evaluation.yaw_max_rad, evaluation.num_compared,
      evaluation.num_outside);
}

}  // namespace

int run_evaluate(const EvaluateOptions& options) {
  const std::string map_csv = in_folder(options.map_path, "map.csv");
  const evaluation::MapEvaluation evaluation = evaluation::evaluate_map(
      io::read_map_csv(map_csv), io::read_truth_csv(options.truth_path), options.gate_m);
  if (options.json) {
    std::fputs(evaluation_json(evaluation).c_str(), stdout);
  } else {
    std::printf("%s\n%s", paper_tables(evaluation).c_str(), evaluation_summary(evaluation).c_str());
    if (!options.poses_path.empty()) print_trajectory(options);
  }
  return options.check && !evaluation.perfect() ? bus::kExitRuntime : bus::kExitOk;
}

}  // namespace orchard::cli
