// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/logs/logs.hpp"
#include "evaluation/row_evaluation.hpp"
#include "evaluation/trajectory_evaluation.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/gis/plan_file.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/stored_map.hpp"
#include "io/recording/truth_csv.hpp"

namespace orchard::cli {
namespace {

/// The rows of a map of ours, with its corrections.
std::vector<evaluation::RowLine> rows_of_map(const std::string& path) {
  std::vector<evaluation::RowLine> rows;
  for (const mapping::Row& row : io::read_corrected_map(path).rows) {
    evaluation::RowLine line;
    for (const mapping::RowSlot& slot : row.places) {
      if (slot.landmark_id != 0) line.push_back(slot.p_map);
    }
    rows.push_back(std::move(line));
  }
  return rows;
}

/// The rows of a survey. One in degrees comes into the truth's frame by the georeference of the
/// trajectory's map, and by its alignment.
std::vector<evaluation::RowLine> rows_of_survey(const std::string& path,
                                                const std::string& trajectory_path,
                                                const geometry::Pose2& T_truth_estimate) {
  const io::StoredPlan plan = io::read_plan(path, {});
  for (const std::string& note : plan.notes) {
    std::fprintf(stderr, "orchard evaluate trajectory: note: %s\n", note.c_str());
  }
  mapping::OrchardPlan rows_in = plan.plan;
  if (plan.georeference) {
    std::optional<geometry::Georeference> of_map;
    if (std::filesystem::is_directory(trajectory_path)) {
      of_map = io::read_stored_map(trajectory_path).georeference;
    }
    if (!of_map) {
      throw io::FileError(path + " is in degrees, but " + trajectory_path +
                          " is no map folder with a georeference, so its place among the poses is "
                          "unknown; give rows in metres in the frame of --truth, or the folder of "
                          "a map made with GNSS");
    }
    rows_in = io::plan_in_map(plan, *of_map);
  }
  std::vector<evaluation::RowLine> rows;
  for (const mapping::PlannedRow& row : rows_in.rows) {
    evaluation::RowLine line;
    for (const mapping::PlannedTree& tree : row.trees) {
      line.push_back(plan.georeference ? transform(T_truth_estimate, tree.p_plan) : tree.p_plan);
    }
    rows.push_back(std::move(line));
  }
  return rows;
}

std::optional<evaluation::RowEvaluation> judge_rows(
    const EvaluateTrajectoryOptions& options, const evaluation::TrajectoryEvaluation& evaluation) {
  if (options.rows_path.empty()) return std::nullopt;
  std::vector<evaluation::RowLine> rows =
      io::is_map(options.rows_path)
          ? rows_of_map(options.rows_path)
          : rows_of_survey(options.rows_path, options.trajectory_path, evaluation.T_truth_estimate);
  // A tree alone has no direction: it is no row to be beside.
  rows.erase(
      std::remove_if(rows.begin(), rows.end(), [](const auto& row) { return row.size() < 2; }),
      rows.end());
  if (rows.size() < 2) {
    throw io::FileError(options.rows_path +
                        " has fewer than two rows of two trees or more, so there is no aisle to be "
                        "in; give a map or survey of the whole block");
  }
  const evaluation::RowEvaluation judged = evaluation::evaluate_rows(evaluation.compared, rows);
  if (judged.num_compared > 0 && judged.num_in_aisles == 0) {
    throw io::FileError(options.truth_path + " is never between or beside the rows of " +
                        options.rows_path +
                        "; both must be of one block and in one frame, in metres, x and y in this "
                        "order");
  }
  return judged;
}

}  // namespace

int run_evaluate_trajectory(const EvaluateTrajectoryOptions& options) {
  evaluation::TrajectoryRules rules = options.rules;
  if (options.align) rules.alignment = evaluation::Alignment::kRigid;
  if (options.align_origin) rules.alignment = evaluation::Alignment::kOrigin;
  if (options.gap_max_s > 0.0) rules.gap_max_s = options.gap_max_s;
  const std::string path = io::file_in(options.trajectory_path, "trajectory.csv");
  const evaluation::Track estimate = io::read_track_csv(path);
  const evaluation::Track truth = io::read_track_csv(options.truth_path);
  const evaluation::TrajectoryEvaluation evaluation =
      evaluation::evaluate_trajectory(estimate, truth, rules);
  const std::optional<evaluation::RowEvaluation> rows = judge_rows(options, evaluation);
  std::string text;
  if (!options.json) {
    text = trajectory_summary(evaluation, rules) + (rows ? row_summary(*rows) : "");
  } else {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(trajectory_json(evaluation, rules));
    if (rows) json["rows"] = nlohmann::ordered_json::parse(row_json(*rows));
    text = json.dump(2) + "\n";
  }
  std::fputs(text.c_str(), stdout);
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
