// SPDX-License-Identifier: BSD-3-Clause
// moving_robot_seeds CONFIG map|delay FIRST LAST: a robot that drives curves against one that
// stops, and the camera delays that are found. The robot weaves between two rows of twelve trees.
#include <exception>
#include <string>

#include "experiments/json_line.hpp"
#include "system/moving_robot/moving_robot_run.hpp"

namespace {

using namespace orchard::test;
using orchard::io::Config;

void compare(const Config& config, unsigned long first, unsigned long last) {
  const CameraTiming mid{0.0375, 0.0}, late{0.0875, 0.0}, misstamped{0.0375, 0.05};
  Config without = config, calibrated = config, before = config;
  without.detector.use_odometry = false;
  before.mapper.deskew_pose_gap_max_s = 0.0;
  // The delay is measured on drives of other orchards.
  calibrated.camera.delay_s =
      measure_delay({drive(9001, config, misstamped), drive(9002, config, misstamped)}, config)
          .delay_s;
  for (unsigned long seed = first; seed <= last; ++seed) {
    const auto print = [&](const std::string& variant, const Outcome& o) {
      orchard::trials::print_json({{"seed", seed},
                                   {"variant", variant},
                                   {"num", o.map.trees.num},
                                   {"rms_m", o.map.trees.rmse},
                                   {"judged", o.num_judged_tree},
                                   {"observations", o.num_tree_observations},
                                   {"right", o.map.confusion[1][1]},
                                   {"trees", o.map.num_trees}});
    };
    print("stop and go", map_run(stop_and_go(seed, config), without));
    print("mid-sweep", map_run(drive(seed, config, mid), config));
    const auto late_run = drive(seed, config, late);
    print("late", map_run(late_run, config));
    print("late, no odometry", map_run(late_run, without));
    print("late, sweep not undone", map_run(late_run, before));
    const auto wrong = drive(seed, config, misstamped);
    print("stamped late, calibrated", map_run(wrong, calibrated));
    print("stamped late, not calibrated", map_run(wrong, config));
  }
}

void find_delays(const Config& config, unsigned long first, unsigned long last) {
  for (const double delay_s : {0.0, 0.02, 0.05, 0.08}) {
    for (unsigned long seed = first; seed <= last; ++seed) {
      const auto found = measure_delay({drive(seed, config, {0.0375, delay_s})}, config);
      orchard::trials::print_json(
          {{"seed", seed}, {"delay_s", delay_s}, {"found_s", found.delay_s}, {"se_s", found.se_s}});
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: moving_robot_seeds CONFIG map|delay FIRST LAST\n");
    return 2;
  }
  try {
    Config config = orchard::io::load_config(argv[1]);
    config.simulation.orchard.num_rows = 2;
    config.simulation.orchard.trees_per_row = 12;
    (std::string(argv[2]) == "delay" ? find_delays : compare)(config, std::stoul(argv[3]),
                                                              std::stoul(argv[4]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "moving_robot_seeds: %s\n", error.what());
    return 3;
  }
}
