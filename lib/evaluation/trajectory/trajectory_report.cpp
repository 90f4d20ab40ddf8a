// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory/trajectory_report.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "geometry/angles.hpp"

namespace orchard::evaluation {
namespace {

using nlohmann::ordered_json;

constexpr double kDegPerRad = 180.0 / geometry::kPi;

std::string row(const std::string& name, const ErrorStatistics& e, double scale, const char* unit) {
  if (e.num == 0) return fmt::format("{:<26}      -\n", name);
  return fmt::format("{:<26} {:6}  {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f} {:9.4f}  {}\n", name,
                     e.num, scale * e.rmse, scale * e.mean, scale * e.median, scale * e.sd,
                     scale * e.min, scale * e.max, unit);
}

const char* unit_name(DeltaUnit unit) {
  return unit == DeltaUnit::kMetres ? "m" : unit == DeltaUnit::kSeconds ? "s" : "frames";
}

ordered_json statistics_json(const ErrorStatistics& e) {
  if (e.num == 0) return {{"n", 0}};
  return {{"n", e.num},  {"rmse", e.rmse}, {"mean", e.mean}, {"median", e.median},
          {"std", e.sd}, {"min", e.min},   {"max", e.max}};
}

}  // namespace

std::string trajectory_summary(const TrajectoryEvaluation& evaluation,
                               const TrajectoryRules& rules) {
  std::string text =
      fmt::format("{} of {} poses compared with {} true poses: {} outside their time, {} in gaps",
                  evaluation.compared.size(), evaluation.num_estimates, evaluation.num_true,
                  evaluation.num_outside, evaluation.num_in_gaps);
  if (rules.association == Association::kNearest) {
    text += fmt::format(", {} without a partner within {:g} s", evaluation.num_unmatched,
                        rules.max_difference_s);
  } else {
    text += fmt::format(" of more than {:g} s", evaluation.gap_max_s);
  }
  text += "\n";
  if (rules.alignment != Alignment::kNone) {
    const geometry::Pose2& t = evaluation.T_truth_estimate;
    text +=
        fmt::format("aligned {}: moved by ({:.3f}, {:.3f}) m, rotated by {:.3f} degrees\n",
                    rules.alignment == Alignment::kRigid ? "by least squares" : "at the first pose",
                    t.x_m, t.y_m, kDegPerRad * t.yaw_rad);
  }
  text += fmt::format("{:<26} {:>6}  {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "", "n", "RMSE",
                      "mean", "median", "sd", "min", "max");
  text += row("APE position (ATE)", evaluation.position_m, 1.0, "m");
  text += row("APE yaw", evaluation.yaw_rad, kDegPerRad, "deg");
  const std::string position_name =
      fmt::format("RPE {}, {:g} {}", evaluation.has_yaw ? "position" : "distance", rules.delta,
                  unit_name(rules.unit));
  text += row(position_name, evaluation.relative_position_m, 1.0, "m");
  const std::string yaw_name = fmt::format("RPE yaw, {:g} {}", rules.delta, unit_name(rules.unit));
  text += row(yaw_name, evaluation.relative_yaw_rad, kDegPerRad, "deg");
  if (!evaluation.has_yaw) text += "one trajectory has no headings: yaw is not evaluated\n";
  return text;
}

std::string trajectory_json(const TrajectoryEvaluation& evaluation, const TrajectoryRules& rules) {
  constexpr const char* kAlignments[] = {"none", "rigid", "origin"};
  const geometry::Pose2& t = evaluation.T_truth_estimate;
  ordered_json json{{"num_estimates", evaluation.num_estimates},
                    {"num_true", evaluation.num_true},
                    {"num_compared", evaluation.compared.size()},
                    {"num_outside", evaluation.num_outside},
                    {"num_in_gaps", evaluation.num_in_gaps},
                    {"num_unmatched", evaluation.num_unmatched},
                    {"gap_max_s", evaluation.gap_max_s},
                    {"alignment", kAlignments[static_cast<std::size_t>(rules.alignment)]},
                    {"aligned_by", {{"x_m", t.x_m}, {"y_m", t.y_m}, {"yaw_rad", t.yaw_rad}}},
                    {"way_m", evaluation.compared.empty() ? 0.0 : evaluation.compared.back().way_m},
                    {"has_yaw", evaluation.has_yaw},
                    {"ape_position_m", statistics_json(evaluation.position_m)},
                    {"ape_yaw_rad", statistics_json(evaluation.yaw_rad)},
                    {"rpe_delta", rules.delta},
                    {"rpe_unit", unit_name(rules.unit)},
                    {"rpe_all_pairs", rules.all_pairs},
                    {"rpe_position_m", statistics_json(evaluation.relative_position_m)},
                    {"rpe_yaw_rad", statistics_json(evaluation.relative_yaw_rad)}};
  return json.dump(2) + "\n";
}

}  // namespace orchard::evaluation
