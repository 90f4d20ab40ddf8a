// SPDX-License-Identifier: BSD-3-Clause
// make_golden_log FILE: wrote tests/data/golden_2.lcm, a log with messages of the types that came
// after the first release. Values are chosen by hand; tests/data/golden_2.txt states them, and
// golden_log_test reads both. (golden.lcm was written by the first release's form of this.)
#include <cstdio>
#include <exception>
#include <string>

#include "bus/codec.hpp"
#include "io/log_writer.hpp"

namespace orchard::bus {
namespace {

constexpr std::int64_t kStart = 1700000000000000;

/// Every message of the log comes a millisecond after the one before.
class Golden {
 public:
  explicit Golden(const std::string& path) : writer_(path) {}
  std::int64_t next_utime() { return utime_ += 1000; }
  void add(const Message& message) {
    writer_.write(utime_, info(channel_of(message)).name, encode(message));
  }
  void close() { writer_.close(); }

 private:
  io::LogWriter writer_;
  std::int64_t utime_ = kStart - 1000;
};

void add_detections(Golden& golden) {
  detection::Detection trunk;
  trunk.utime = kStart + 5;
  trunk.range_m = 2;
  trunk.bearing_rad = 0.25;
  trunk.surface_x_m = 1.875;
  trunk.surface_y_m = 0.625;
  trunk.centre_x_m = 1.9375;
  trunk.centre_y_m = 0.65625;
  trunk.covariance = {0.25, 0.0625, 0.5};
  trunk.width_m = 0.09375;
  trunk.width_sd_m = 0.0078125;
  trunk.roc_laser = 0.875f;
  trunk.roc_colour = 0.75f;
  trunk.roc_left_edge = 0.625f;
  trunk.roc_right_edge = 0.5f;
  trunk.roc_parallel = 0.375f;
  trunk.roc_edges = 0.25f;
  trunk.roc_vision = 0.125f;
  trunk.roc_tree = 0.9375f;
  trunk.probability_tree = 0.625f;
  trunk.probability_object = 0.25f;
  trunk.intensity = 1234.5f;
  trunk.num_beams = 9;
  trunk.label = detection::Label::kTree;
  trunk.occlusion = detection::kOccludedLeft;
  detection::Detections detections;
  detections.utime = golden.next_utime();
  detections.image_utime = kStart + 2;
  detections.trunks = {trunk, trunk};
  detections.trunks[1].label = detection::Label::kUnseen;
  golden.add(detections);
}

void add_adaptation(Golden& golden) {
  detection::AdaptationStep step;
  step.utime = golden.next_utime();
  step.seq = 4;
  step.action = detection::AdaptationAction::kRollback;
  step.reason = detection::AdaptationReason::kConfidenceCollapsed;
  step.num_width_trees = 12;
  step.num_colour_trees = 9;
  step.confident_share = 0.375;
  step.model.width_mean_m = 0.125;
  step.model.light = {-0.25, 0.0625, 0.5};
  golden.add(step);
}

}  // namespace
}  // namespace orchard::bus

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_golden_log FILE\n");
    return 2;
  }
  try {
    orchard::bus::Golden golden(argv[1]);
    add_detections(golden);
    add_adaptation(golden);
    golden.close();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_golden_log: %s\n", error.what());
    return 1;
  }
}
