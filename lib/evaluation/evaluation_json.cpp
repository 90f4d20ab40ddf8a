// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "detection/detection.hpp"
#include "evaluation/error_summary_json.hpp"
#include "evaluation/paper_tables.hpp"

namespace orchard::evaluation {
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
