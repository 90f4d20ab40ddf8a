// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/paper_tables.hpp"

#include <fmt/core.h>

#include "detection/detection.hpp"
#include "geometry/angles.hpp"
#include "text/number_text.hpp"

namespace orchard::evaluation {
namespace {

using detection::Label;

constexpr double kMmPerM = 1000.0;

/// Three digits as in the paper's table 1; four for the small values of its table 2.
std::string roc_text(double roc) { return fixed_text(roc, roc < 0.1 ? 4 : 3); }

std::string row(const EvaluatedObject& object) {
  const char* name = object.truth.name.c_str();
  if (!object.landmark) return fmt::format("{:<8} {:>4}   missed\n", name, "-");
  const mapping::Landmark& landmark = *object.landmark;
  std::string line =
      fmt::format("{:<8} {:4} {:>14} {:10.2f} {:10.2f} {:25.2f}", name, landmark.num_observations,
                  roc_text(landmark.roc_mean), kMmPerM * landmark.se_x_m, kMmPerM * landmark.se_y_m,
                  kMmPerM * object.error_m);
  if (!object.right_class()) line += fmt::format("   mapped as {}", label_text(landmark.label));
  return line + "\n";
}

std::string table(const MapEvaluation& evaluation, Label label, const char* title,
                  const char* first_column) {
  std::string text =
      fmt::format("{}\n{:<8} {:>4} {:>14} {:>10} {:>10} {:>25}\n", title, first_column, "N",
                  "ROC_tree_mean", "SE_x (mm)", "SE_y (mm)", "error against truth (mm)");
  int num = 0;
  double roc_sum = 0.0;
  double se_x_sum_m = 0.0;
  double se_y_sum_m = 0.0;
  double error_sum_m = 0.0;
  for (const EvaluatedObject& object : evaluation.objects) {
    if (object.truth.label != label) continue;
    text += row(object);
    if (!object.landmark) continue;
    ++num;
    roc_sum += object.landmark->roc_mean;
    se_x_sum_m += object.landmark->se_x_m;
    se_y_sum_m += object.landmark->se_y_m;
    error_sum_m += object.error_m;
  }
  if (num == 0) return text;
  text += fmt::format("{:<8} {:>4} {:>14} {:10.2f} {:10.2f} {:25.2f}\n", "mean", "",
                      roc_text(roc_sum / num), kMmPerM * se_x_sum_m / num,
                      kMmPerM * se_y_sum_m / num, kMmPerM * error_sum_m / num);
  return text;
}

}  // namespace

std::string paper_tables(const MapEvaluation& evaluation) {
  return table(evaluation, Label::kTree, "Table 1: the trees", "Tree") + "\n" +
         table(evaluation, Label::kObject, "Table 2: the other objects", "Object");
}

std::string evaluation_summary(const MapEvaluation& evaluation) {
  const int num_truth = evaluation.num_trees + evaluation.num_objects;
  std::string text = fmt::format(
      "found {} of {} ({} trees, {} objects) within {:.2f} m; wrong class: {}; extra: {}\n",
      evaluation.all.num, num_truth, evaluation.num_trees, evaluation.num_objects,
      evaluation.gate_m, evaluation.num_wrong_class, evaluation.extra.size());
  text += fmt::format("error against truth: RMS {:.2f} mm, mean {:.2f} mm, largest {:.2f} mm\n",
                      kMmPerM * evaluation.all.rms_m, kMmPerM * evaluation.all.mean_m,
                      kMmPerM * evaluation.all.max_m);
  if (evaluation.unaligned) {
    const Unaligned& before = *evaluation.unaligned;
    text += fmt::format("trees: missed {} of {}, mapped twice {}, error RMS {:.2f} mm\n",
                        evaluation.num_trees_missed, evaluation.num_trees,
                        evaluation.num_duplicates, kMmPerM * evaluation.trees.rms_m);
    text += fmt::format(
        "aligned on the trees: moved by ({:.3f}, {:.3f}) m, rotated by {:.3f} degrees; without "
        "alignment {} trees found, error RMS {:.2f} mm\n",
        before.T_truth_map.x_m, before.T_truth_map.y_m,
        180.0 / geometry::kPi * before.T_truth_map.yaw_rad, before.num_trees_found,
        kMmPerM * before.trees.rms_m);
  }
  for (const mapping::Landmark& landmark : evaluation.extra) {
    text += fmt::format("extra landmark {} ({}, {} observations) at ({:.3f}, {:.3f}) m\n",
                        landmark.id, label_text(landmark.label), landmark.num_observations,
                        landmark.x_m, landmark.y_m);
  }
  return text;
}

}  // namespace orchard::evaluation
