// SPDX-License-Identifier: BSD-3-Clause
#include "cli/evaluate/evaluate_trajectory.hpp"

#include <cstdio>
#include <filesystem>

#include "bus/process/process.hpp"
#include "evaluation/trajectory/trajectory_report.hpp"
#include "io/file_error.hpp"
#include "io/recording/truth_csv.hpp"

namespace orchard::cli {

namespace fs = std::filesystem;

int run_evaluate_trajectory(const EvaluateTrajectoryOptions& options) {
  evaluation::TrajectoryRules rules = options.rules;
  if (options.align) rules.alignment = evaluation::Alignment::kRigid;
  if (options.align_origin) rules.alignment = evaluation::Alignment::kOrigin;
  if (options.nearest) rules.association = evaluation::Association::kNearest;
  if (options.gap_max_s > 0.0) rules.gap_max_s = options.gap_max_s;
  const std::string path = fs::is_directory(options.trajectory_path)
                               ? (fs::path(options.trajectory_path) / "trajectory.csv").string()
                               : options.trajectory_path;
  const evaluation::Track estimate = io::read_track_csv(path);
  const evaluation::Track truth = io::read_track_csv(options.truth_path);
  const evaluation::TrajectoryEvaluation evaluation =
      evaluation::evaluate_trajectory(estimate, truth, rules);
  std::fputs(
      (options.json ? trajectory_json(evaluation, rules) : trajectory_summary(evaluation, rules))
          .c_str(),
      stdout);
  if (evaluation.compared.empty()) {
    std::fprintf(stderr,
                 "orchard evaluate trajectory: no pose of %s is within the time of %s, so nothing "
                 "can be compared; check that both are of one drive and in microseconds\n",
                 path.c_str(), options.truth_path.c_str());
    return bus::kExitRuntime;
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
