// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::simulation {

/// A park: few trees in irregular positions, and a car that drives among them. Section
/// `simulation.park`.
struct ParkConfig {
  double length_m = 250.0;  ///< of the ground, along map x; the car starts in its middle
  double width_m = 200.0;   ///< along map y
  int num_trees = 160;
  double clump_fraction = 0.4;      ///< fraction of the trees in groups
  double trees_apart_m = 1.5;       ///< min distance between two trees
  double trunk_width_min_m = 0.15;  ///< most trunks are close to this width
  double trunk_width_max_m = 0.9;
  int num_bushes = 15;
  double way_m = 4000.0;  ///< length of the drive between waypoints, half of them revisited
  double speed_mps = 3.0;
  double turn_radius_m = 6.0;  ///< of the car at full lock
};

template <class Visitor>
void describe(Visitor& v, ParkConfig& c) {
  v.number("way_m", c.way_m, 10, 1e5, "m", "length of the drive");
  v.number("speed_mps", c.speed_mps, 0.05, 20, "m/s", "speed of the car");
}

}  // namespace orchard::simulation
