// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/map_evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "evaluation/assignment.hpp"

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

ErrorSummary summarise(const std::vector<double>& errors_m) {
  ErrorSummary summary;
  summary.num = static_cast<int>(errors_m.size());
  if (errors_m.empty()) return summary;
  double sum_m = 0.0;
  double sum_m2 = 0.0;
  for (const double error_m : errors_m) {
    sum_m += error_m;
    sum_m2 += error_m * error_m;
    summary.max_m = std::max(summary.max_m, error_m);
  }
  summary.mean_m = sum_m / summary.num;
  summary.rms_m = std::sqrt(sum_m2 / summary.num);
  return summary;
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
  evaluation.all = summarise(errors_m);
  evaluation.trees = summarise(tree_errors_m);
  if (evaluation.trees.num == 0) return;
  evaluation.roc_mean_trees /= evaluation.trees.num;
  evaluation.se_x_mean_m /= evaluation.trees.num;
  evaluation.se_y_mean_m /= evaluation.trees.num;
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
  evaluation.unaligned = Unaligned{T_truth_map, as_it_came.trees.num, as_it_came.trees};
  return evaluation;
}

}  // namespace orchard::evaluation
