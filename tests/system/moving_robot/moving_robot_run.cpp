// SPDX-License-Identifier: BSD-3-Clause
#include "system/moving_robot/moving_robot_run.hpp"

#include <algorithm>
#include <cmath>

#include "cli/calibrate/delay_collector.hpp"
#include "detector/detector_node.hpp"
#include "mapper/mapper_node.hpp"
#include "pose/pose_node.hpp"
#include "system/tube_scene/wiring.hpp"

namespace orchard::test {
namespace {

constexpr double kGate_m = 0.3;
constexpr float kRocLaserMin = 0.0112f;  // DetectorConfig::kRocLaserMin

/// Counts how detections of true trees were judged.
class Judge : public bus::Node {
 public:
  Judge(const RobotRun& run, Outcome& outcome) : run_(run), outcome_(outcome) {}
  std::string_view name() const override { return "judge"; }
  std::vector<bus::Channel> inputs() const override { return {bus::Channel::kDetections}; }
  void flush(const bus::Outbox&) override {}
  void handle(const bus::Message& input, const bus::Outbox&) override {
    for (const auto& d : std::get<detection::Detections>(input).trunks) {
      // the camera judges what the laser takes for a trunk
      if (d.label == detection::Label::kUnseen || d.roc_laser < kRocLaserMin) continue;
      const auto p = geometry::compose(run_.pose_at(d.utime), {d.centre_x_m, d.centre_y_m, 0.0});
      const bool at_tree =
          std::any_of(run_.truth.begin(), run_.truth.end(), [&](const auto& object) {
            return object.label == detection::Label::kTree &&
                   std::hypot(object.x_m - p.x_m, object.y_m - p.y_m) < kGate_m;
          });
      if (!at_tree) continue;
      ++outcome_.num_tree_observations;
      if (d.label == detection::Label::kTree) ++outcome_.num_judged_tree;
    }
  }

 private:
  const RobotRun& run_;
  Outcome& outcome_;
};

}  // namespace

Outcome map_run(const RobotRun& run, const io::Config& config) {
  Outcome outcome;
  procs::DetectorNode detector(config);
  procs::PoseNode pose(config);
  procs::MapperNode mapper(config);
  Judge judge(run, outcome);
  Wiring wiring({&detector, &pose, &mapper, &judge});
  for (const bus::Message& message : run.messages) wiring.put(message);
  wiring.flush();
  outcome.map = evaluation::evaluate_map(mapper.landmarks(), run.truth, kGate_m);
  return outcome;
}

calibration::DelayEstimate measure_delay(const std::vector<RobotRun>& runs, io::Config config) {
  calibration::DelayEstimate estimate;
  for (int round = 0; round < 6; ++round) {
    std::vector<calibration::DelayObservation> observations;
    std::int32_t next_picture = 0;
    for (const RobotRun& run : runs) {
      cli::DelayCollector collector(config, next_picture);
      Wiring wiring({&collector});
      for (const bus::Message& message : run.messages) wiring.put(message);
      wiring.flush();
      observations.insert(observations.end(), collector.observations().begin(),
                          collector.observations().end());
      next_picture = collector.next_picture();
    }
    estimate = calibration::estimate_delay(observations, {});
    config.camera.delay_s += estimate.delay_s;
    if (std::abs(estimate.delay_s) < 0.0005) break;
  }
  estimate.delay_s = config.camera.delay_s;
  return estimate;
}

}  // namespace orchard::test
