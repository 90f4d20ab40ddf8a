// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/map_evaluation.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "detection/detection.hpp"
#include "evaluation/assignment.hpp"
#include "geometry/angles.hpp"
#include "text/number_text.hpp"

namespace orchard::evaluation {
namespace {

using detection::Label;

std::vector<EvaluatedObject> named(const std::vector<simulation::TruthObject>& truth) {
  std::vector<EvaluatedObject> objects;
  int num_trees = 0;
  int num_objects = 0;
  for (const simulation::TruthObject& thing : truth) {
    if (thing.label == Label::kUnseen) {
      throw std::invalid_argument("evaluate_map: the truth has an object without a class");
    }
    EvaluatedObject object;
    object.truth = thing;
    object.truth.name = thing.label == Label::kTree ? "T" + std::to_string(++num_trees)
                                                    : "B" + std::to_string(++num_objects);
    objects.push_back(std::move(object));
  }
  return objects;
}

void match(const std::vector<mapping::Landmark>& landmarks, MapEvaluation& evaluation) {
  std::vector<Point> true_points;
  for (const EvaluatedObject& object : evaluation.objects) {
    true_points.push_back({object.truth.x_m, object.truth.y_m});
  }
  std::vector<Point> found_points;
  for (const mapping::Landmark& landmark : landmarks) {
    found_points.push_back({landmark.x_m, landmark.y_m});
  }
  const Assignment assignment = assign(true_points, found_points, evaluation.gate_m);
  std::vector<bool> used(landmarks.size(), false);
  for (std::size_t i = 0; i < assignment.size(); ++i) {
    if (assignment[i] == kUnmatched) continue;
    const auto found = static_cast<std::size_t>(assignment[i]);
    EvaluatedObject& object = evaluation.objects[i];
    used[found] = true;
    object.landmark = landmarks[found];
    object.error_x_m = landmarks[found].x_m - object.truth.x_m;
    object.error_y_m = landmarks[found].y_m - object.truth.y_m;
    object.error_m = std::hypot(object.error_x_m, object.error_y_m);
  }
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!used[i]) evaluation.extra.push_back(landmarks[i]);
  }
  std::sort(evaluation.extra.begin(), evaluation.extra.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
}

void count(MapEvaluation& evaluation) {
  std::vector<double> errors_m;
  std::vector<double> tree_errors_m;
  for (const EvaluatedObject& object : evaluation.objects) {
    const bool is_tree = object.truth.label == Label::kTree;
    ++(is_tree ? evaluation.num_trees : evaluation.num_objects);
    if (!object.landmark) {
      ++evaluation.num_missed;
      evaluation.num_trees_missed += is_tree;
      continue;
    }
    ++evaluation.confusion[static_cast<std::size_t>(object.truth.label)]
                          [static_cast<std::size_t>(object.landmark->label)];
    if (!object.right_class()) ++evaluation.num_wrong_class;
    errors_m.push_back(object.error_m);
    if (!is_tree) continue;
    tree_errors_m.push_back(object.error_m);
    evaluation.roc_mean_trees += object.landmark->roc_mean;
    evaluation.se_x_mean_m += object.landmark->se_x_m;
    evaluation.se_y_mean_m += object.landmark->se_y_m;
  }
  evaluation.all = error_statistics(std::move(errors_m));
  evaluation.trees = error_statistics(std::move(tree_errors_m));
  if (evaluation.trees.num == 0) return;
  evaluation.roc_mean_trees /= evaluation.trees.num;
  evaluation.se_x_mean_m /= evaluation.trees.num;
  evaluation.se_y_mean_m /= evaluation.trees.num;
}

/// `offset_m`: of the map's heights.
void judge_heights(double offset_m, MapEvaluation& evaluation) {
  std::vector<double> errors_m;
  evaluation.height_nees = 0.0;
  for (const EvaluatedObject& object : evaluation.objects) {
    if (!object.has_heights()) continue;
    errors_m.push_back(object.height_error_m() - offset_m);
    evaluation.height_nees += std::pow(errors_m.back() / object.landmark->z_sd_m, 2);
  }
  if (!errors_m.empty()) evaluation.height_nees /= static_cast<double>(errors_m.size());
  for (double& error_m : errors_m) error_m = std::abs(error_m);
  evaluation.heights = error_statistics(std::move(errors_m));
}

double mean_height_error_m(const MapEvaluation& evaluation) {
  double sum_m = 0.0;
  for (const EvaluatedObject& object : evaluation.objects) {
    if (object.has_heights()) sum_m += object.height_error_m();
  }
  return sum_m / std::max(1, evaluation.heights.num);
}

void count_duplicates(MapEvaluation& evaluation) {
  // Sorted by x: for an extra landmark only trees within the gate's band are visited.
  std::vector<Point> trees;
  for (const EvaluatedObject& object : evaluation.objects) {
    if (object.truth.label == Label::kTree && object.landmark) {
      trees.push_back({object.truth.x_m, object.truth.y_m});
    }
  }
  std::sort(trees.begin(), trees.end(),
            [](const Point& a, const Point& b) { return a.x_m < b.x_m; });
  for (const mapping::Landmark& extra : evaluation.extra) {
    if (extra.label != Label::kTree) continue;
    auto it = std::lower_bound(trees.begin(), trees.end(), extra.x_m - evaluation.gate_m,
                               [](const Point& tree, double x_m) { return tree.x_m < x_m; });
    for (; it != trees.end() && it->x_m <= extra.x_m + evaluation.gate_m; ++it) {
      if (std::hypot(it->x_m - extra.x_m, it->y_m - extra.y_m) > evaluation.gate_m) continue;
      ++evaluation.num_duplicates;
      break;
    }
  }
}

template <class Things, class Where>
std::vector<Point> points_of(const Things& things, bool trees_only, const Where& where) {
  std::vector<Point> points;
  for (const auto& thing : things) {
    if (!trees_only || thing.label == Label::kTree) points.push_back(where(thing));
  }
  return points;
}

}  // namespace

MapEvaluation evaluate_map(const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<simulation::TruthObject>& truth, double gate_m) {
  MapEvaluation evaluation;
  evaluation.gate_m = gate_m;
  evaluation.objects = named(truth);
  match(landmarks, evaluation);
  count(evaluation);
  count_duplicates(evaluation);
  judge_heights(0.0, evaluation);
  return evaluation;
}

MapEvaluation evaluate_aligned_map(const std::vector<mapping::Landmark>& landmarks,
                                   const std::vector<simulation::TruthObject>& truth, double gate_m,
                                   const AlignmentSearch& search,
                                   const std::optional<geometry::Pose2>& guess) {
  const auto where = [](const auto& thing) { return Point{thing.x_m, thing.y_m}; };
  std::vector<Point> true_points = points_of(truth, true, where);
  std::vector<Point> found_points = points_of(landmarks, true, where);
  if (true_points.size() < 3 || found_points.size() < 3) {
    true_points = points_of(truth, false, where);
    found_points = points_of(landmarks, false, where);
  }
  const MapEvaluation as_it_came = evaluate_map(landmarks, truth, gate_m);
  const geometry::Pose2 T_truth_map =
      align_points(true_points, found_points, gate_m, search, guess).value_or(geometry::Pose2{});
  std::vector<mapping::Landmark> moved = landmarks;
  for (mapping::Landmark& landmark : moved) {
    const Point p = transform(T_truth_map, where(landmark));
    landmark.x_m = p.x_m;
    landmark.y_m = p.y_m;
  }
  MapEvaluation evaluation = evaluate_map(moved, truth, gate_m);
  judge_heights(mean_height_error_m(evaluation), evaluation);
  evaluation.unaligned = Unaligned{T_truth_map, as_it_came.trees.num, as_it_came.trees};
  return evaluation;
}

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
                      kMmPerM * evaluation.all.rmse, kMmPerM * evaluation.all.mean,
                      kMmPerM * evaluation.all.max);
  if (evaluation.heights.num > 0) {
    text += fmt::format(
        "heights of {}: RMS {:.1f} mm, largest {:.1f} mm, squared error over the claim {:.2f}\n",
        evaluation.heights.num, kMmPerM * evaluation.heights.rmse, kMmPerM * evaluation.heights.max,
        evaluation.height_nees);
  }
  if (evaluation.unaligned) {
    const Unaligned& before = *evaluation.unaligned;
    text += fmt::format("trees: missed {} of {}, mapped twice {}, error RMS {:.2f} mm\n",
                        evaluation.num_trees_missed, evaluation.num_trees,
                        evaluation.num_duplicates, kMmPerM * evaluation.trees.rmse);
    text += fmt::format(
        "aligned on the trees: moved by ({:.3f}, {:.3f}) m, rotated by {:.3f} degrees; without "
        "alignment {} trees found, error RMS {:.2f} mm\n",
        before.T_truth_map.x_m, before.T_truth_map.y_m,
        180.0 / geometry::kPi * before.T_truth_map.yaw_rad, before.num_trees_found,
        kMmPerM * before.trees.rmse);
  }
  for (const mapping::Landmark& landmark : evaluation.extra) {
    text += fmt::format("extra landmark {} ({}, {} observations) at ({:.3f}, {:.3f}) m\n",
                        landmark.id, label_text(landmark.label), landmark.num_observations,
                        landmark.x_m, landmark.y_m);
  }
  return text;
}

namespace {

using detection::Label;
using nlohmann::ordered_json;

ordered_json landmark_json(const mapping::Landmark& landmark) {
  return {{"id", landmark.id},
          {"class", label_text(landmark.label)},
          {"x_m", landmark.x_m},
          {"y_m", landmark.y_m},
          {"n", landmark.num_observations},
          {"roc_mean", landmark.roc_mean},
          {"se_x_m", landmark.se_x_m},
          {"se_y_m", landmark.se_y_m},
          {"width_m", landmark.width_m}};
}

ordered_json object_json(const EvaluatedObject& object) {
  ordered_json json{{"name", object.truth.name},       {"class", label_text(object.truth.label)},
                    {"x_m", object.truth.x_m},         {"y_m", object.truth.y_m},
                    {"width_m", object.truth.width_m}, {"found", object.landmark.has_value()}};
  if (object.landmark) {
    json["landmark"] = landmark_json(*object.landmark);
    json["error_x_m"] = object.error_x_m;
    json["error_y_m"] = object.error_y_m;
    json["error_m"] = object.error_m;
  }
  return json;
}

ordered_json confusion_json(const MapEvaluation& evaluation) {
  ordered_json json;
  for (const Label truth : {Label::kTree, Label::kObject}) {
    for (const Label found : {Label::kTree, Label::kObject, Label::kUnseen}) {
      json[label_text(truth)][label_text(found)] =
          evaluation.confusion[static_cast<std::size_t>(truth)][static_cast<std::size_t>(found)];
    }
  }
  return json;
}

}  // namespace

std::string evaluation_json(const MapEvaluation& evaluation) {
  ordered_json json{{"gate_m", evaluation.gate_m},
                    {"num_trees", evaluation.num_trees},
                    {"num_objects", evaluation.num_objects},
                    {"num_found", evaluation.all.num},
                    {"num_missed", evaluation.num_missed},
                    {"num_wrong_class", evaluation.num_wrong_class},
                    {"num_extra", evaluation.extra.size()},
                    {"num_trees_missed", evaluation.num_trees_missed},
                    {"num_duplicates", evaluation.num_duplicates},
                    {"perfect", evaluation.perfect()},
                    {"error_all", errors_json<ordered_json>(evaluation.all)},
                    {"error_trees", errors_json<ordered_json>(evaluation.trees)},
                    {"roc_mean_trees", evaluation.roc_mean_trees},
                    {"se_x_mean_m", evaluation.se_x_mean_m},
                    {"se_y_mean_m", evaluation.se_y_mean_m},
                    {"confusion", confusion_json(evaluation)}};
  if (evaluation.heights.num > 0) {
    json["error_heights"] = errors_json<ordered_json>(evaluation.heights);
    json["height_nees"] = evaluation.height_nees;
  }
  if (evaluation.unaligned) {
    const geometry::Pose2& t = evaluation.unaligned->T_truth_map;
    json["aligned_by"] = {{"x_m", t.x_m}, {"y_m", t.y_m}, {"yaw_rad", t.yaw_rad}};
    json["error_trees_unaligned"] = errors_json<ordered_json>(evaluation.unaligned->trees);
  }
  json["objects"] = ordered_json::array();
  for (const EvaluatedObject& object : evaluation.objects) {
    json["objects"].push_back(object_json(object));
  }
  json["extra"] = ordered_json::array();
  for (const mapping::Landmark& landmark : evaluation.extra) {
    json["extra"].push_back(landmark_json(landmark));
  }
  return json.dump(2) + "\n";
}

}  // namespace orchard::evaluation
