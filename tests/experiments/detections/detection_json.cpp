// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "evaluation/map_evaluation.hpp"
#include "experiments/detections/detection_evaluation.hpp"

namespace orchard::evaluation {
namespace {

using nlohmann::ordered_json;

ordered_json counts_json(const Counts& c) {
  return {{"precision", c.precision()},
          {"recall", c.recall()},
          {"f1", c.f1()},
          {"num_right", c.num_right},
          {"num_wrong", c.num_wrong},
          {"num_missed", c.num_missed},
          {"num_wrong_on_object", c.num_wrong_on_object},
          {"num_unseen", c.num_unseen},
          {"num_not_detected", c.num_not_detected}};
}

ordered_json reliability_json(const Reliability& r) {
  ordered_json json{{"expected_calibration_error", r.expected_calibration_error},
                    {"brier_score", r.brier_score},
                    {"num", r.num},
                    {"bins", ordered_json::array()}};
  for (const ReliabilityBin& bin : r.bins) {
    json["bins"].push_back({{"from", bin.from},
                            {"to", bin.to},
                            {"num", bin.num},
                            {"mean_probability", bin.mean_probability},
                            {"frequency", bin.frequency}});
  }
  return json;
}

ordered_json slices_json(const std::vector<Slice>& slices) {
  ordered_json list = ordered_json::array();
  for (const Slice& slice : slices) {
    ordered_json json = counts_json(slice.counts);
    json["name"] = slice.name;
    json["from_m"] = slice.from_m;
    json["to_m"] = slice.to_m;
    json["centre_error"] = errors_json<ordered_json>(slice.centre);
    list.push_back(std::move(json));
  }
  return list;
}

ordered_json test_json(const ScoreTest& test) {
  return {{"name", test.name},
          {"mean_of_trees", test.mean_of_trees},
          {"mean_of_others", test.mean_of_others},
          {"area", test.area},
          {"best_threshold", test.best_threshold},
          {"best", counts_json(test.best)},
          {"recall_precision", test.curve}};
}

}  // namespace

std::string detection_json(const DetectionEvaluation& e) {
  ordered_json json{{"range_max_m", e.rules.range_max_m},
                    {"num_beams_min", e.rules.num_beams_min},
                    {"hidden_max", e.rules.hidden_max},
                    {"in_picture", e.rules.in_picture},
                    {"gate_m", e.rules.gate_m},
                    {"num_scans", e.num_scans},
                    {"num_looks", e.num_observations},
                    {"observations", counts_json(e.counts)},
                    {"by_range", slices_json(e.by_range)},
                    {"by_recording", slices_json(e.by_recording)},
                    {"tests", ordered_json::array()}};
  for (const ScoreTest& test : e.tests) json["tests"].push_back(test_json(test));
  if (e.has_probability) json["probability"] = reliability_json(e.reliability);
  if (e.landmarks) {
    json["landmarks"] = counts_json(e.landmarks->counts);
    json["landmarks"]["centre_error"] = errors_json<ordered_json>(e.landmarks->trees);
    json["landmarks"]["probability"] = reliability_json(e.landmarks->reliability);
  }
  return json.dump(2) + "\n";
}

}  // namespace orchard::evaluation
