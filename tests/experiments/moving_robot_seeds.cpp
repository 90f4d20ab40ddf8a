// SPDX-License-Identifier: BSD-3-Clause
// For people: tests/experiments/moving_robot.sh. A robot that drives curves against one that stops,
// and the delays that are found, seed by seed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "system/moving_robot/moving_robot_run.hpp"

namespace {

using orchard::io::Config;
using orchard::test::CameraTiming;
using orchard::test::Outcome;

constexpr int kNumVariants = 8;
const char* const kNames[kNumVariants] = {"stop and go",
                                          "moving, picture at mid-sweep, odometry",
                                          "moving, picture 50 ms late, odometry",
                                          "moving, picture 50 ms late, no odometry",
                                          "moving, stamped 50 ms late, delay calibrated, odometry",
                                          "moving, stamped 50 ms late, not calibrated, odometry",
                                          "moving, stamped 50 ms late, not calibrated, no odometry",
                                          "moving, picture 50 ms late, sweep not undone (before)"};

struct Sum {
  double square_m2 = 0.0;
  double most_m = 0.0;  ///< largest excess over stop and go of a seed's RMS
  int num = 0, found = 0, trees = 0, right_class = 0;
  long observations = 0, judged = 0;

  void add(const Outcome& o, double stopped_m) {
    square_m2 += o.map.trees.num * o.map.trees.rms_m * o.map.trees.rms_m;
    num += o.map.trees.num;
    most_m = std::max(most_m, o.map.trees.rms_m - stopped_m);
    trees += o.map.num_trees;
    right_class += o.map.confusion[1][1];
    observations += o.num_tree_observations;
    judged += o.num_judged_tree;
  }
  double rms_mm() const { return num > 0 ? 1e3 * std::sqrt(square_m2 / num) : 0.0; }
};

int compare(Config config, unsigned long first, unsigned long last) {
  const CameraTiming mid{0.0375, 0.0}, late{0.0875, 0.0}, misstamped{0.0375, 0.05};
  // The delay is measured on drives of other orchards.
  const auto delay = orchard::test::measure_delay({orchard::test::drive(9001, config, misstamped),
                                                   orchard::test::drive(9002, config, misstamped)},
                                                  config);
  std::printf(
      "delay calibrated on seeds 9001, 9002: %.1f ms (standard error %.1f ms), truth 50 ms\n",
      1e3 * delay.delay_s, 1e3 * delay.se_s);
  Config without = config, calibrated = config, before = config;
  without.detector.use_odometry = false;
  before.mapper.deskew_pose_gap_max_s = 0.0;
  calibrated.camera.delay_s = delay.delay_s;
  std::vector<Sum> sums(kNumVariants);
  for (unsigned long seed = first; seed <= last; ++seed) {
    const auto stopped = orchard::test::map_run(orchard::test::stop_and_go(seed, config), without);
    const double stopped_m = stopped.map.trees.rms_m;
    sums[0].add(stopped, stopped_m);
    const auto mid_run = orchard::test::drive(seed, config, mid);
    const auto late_run = orchard::test::drive(seed, config, late);
    const auto misstamped_run = orchard::test::drive(seed, config, misstamped);
    sums[1].add(orchard::test::map_run(mid_run, config), stopped_m);
    sums[2].add(orchard::test::map_run(late_run, config), stopped_m);
    sums[3].add(orchard::test::map_run(late_run, without), stopped_m);
    sums[4].add(orchard::test::map_run(misstamped_run, calibrated), stopped_m);
    sums[5].add(orchard::test::map_run(misstamped_run, config), stopped_m);
    sums[6].add(orchard::test::map_run(misstamped_run, without), stopped_m);
    sums[7].add(orchard::test::map_run(late_run, before), stopped_m);
  }
  std::printf("%-56s %9s %9s %10s %11s %9s\n", "", "RMS mm", "more mm", "worst seed", "looks TREE",
              "trees");
  for (int i = 0; i < kNumVariants; ++i) {
    const Sum& s = sums[static_cast<std::size_t>(i)];
    std::printf("%-56s %9.1f %+9.1f %+10.1f %10.1f%% %4d/%d\n", kNames[i], s.rms_mm(),
                s.rms_mm() - sums[0].rms_mm(), 1e3 * s.most_m,
                s.observations > 0
                    ? 100.0 * static_cast<double>(s.judged) / static_cast<double>(s.observations)
                    : 0.0,
                s.right_class, s.trees);
  }
  const bool kept =
      sums[2].rms_mm() - sums[0].rms_mm() <= 10.0 && sums[4].rms_mm() - sums[0].rms_mm() <= 10.0;
  std::printf("within 10 mm of stop and go: %s\n", kept ? "yes" : "NO");
  return kept ? 0 : 1;
}

int find_delays(const Config& config, unsigned long first, unsigned long last) {
  double worst_ms = 0.0;
  std::printf("%-8s %10s %10s %8s %8s %10s\n", "seed", "truth ms", "found ms", "se ms", "looks",
              "left px");
  for (const double delay_s : {0.0, 0.02, 0.05, 0.08}) {
    for (unsigned long seed = first; seed <= last; ++seed) {
      const auto found = orchard::test::measure_delay(
          {orchard::test::drive(seed, config, {0.0375, delay_s})}, config);
      worst_ms = std::max(worst_ms, 1e3 * std::abs(found.delay_s - delay_s));
      std::printf("%-8lu %10.1f %10.2f %8.2f %8d %10.2f\n", seed, 1e3 * delay_s,
                  1e3 * found.delay_s, 1e3 * found.se_s, found.num_observations, found.offset_px);
    }
  }
  std::printf("worst error %.2f ms; within 5 ms: %s\n", worst_ms, worst_ms <= 5.0 ? "yes" : "NO");
  return worst_ms <= 5.0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: moving_robot_seeds CONFIG map|delay FIRST_SEED LAST_SEED\n");
    return 2;
  }
  try {
    Config config = orchard::io::load_config(argv[1]);
    config.simulation.orchard.num_rows = 2;
    config.simulation.orchard.trees_per_row = 12;
    const unsigned long first = std::stoul(argv[3]), last = std::stoul(argv[4]);
    return std::string(argv[2]) == "delay" ? find_delays(config, first, last)
                                           : compare(config, first, last);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "moving_robot_seeds: %s\n", error.what());
    return 3;
  }
}
