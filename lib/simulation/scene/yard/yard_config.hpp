// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::simulation {

/// A farm yard between blocks. Section `simulation.yard`.
struct YardConfig {
  double speed_mps = 1.0;
  int num_trees = 45;               ///< scattered trees, in addition to those of the block
  double hedge_roughness_m = 0.15;  ///< sd of a hedge's face about its line
};

template <class Visitor>
void describe(Visitor& v, YardConfig& c) {
  v.number("speed_mps", c.speed_mps, 0.05, 10, "m/s", "speed of the robot");
}

}  // namespace orchard::simulation
