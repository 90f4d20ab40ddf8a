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
  v.number("length_m", c.length_m, 50, 5000, "m", "length of the ground, along map x");
  v.number("width_m", c.width_m, 50, 5000, "m", "width of the ground, along map y");
  v.integer("num_trees", c.num_trees, 0, 100000, "trees", "number of trees");
  v.number("clump_fraction", c.clump_fraction, 0, 1, "1",
           "fraction of the trees that stand in groups");
  v.number("trees_apart_m", c.trees_apart_m, 0.1, 20, "m", "min distance of two trees");
  v.number("trunk_width_min_m", c.trunk_width_min_m, 0.02, 3, "m", "min width of a trunk");
  v.number("trunk_width_max_m", c.trunk_width_max_m, 0.02, 3, "m", "max width of a trunk");
  v.integer("num_bushes", c.num_bushes, 0, 10000, "1",
            "number of bushes of twigs, without a trunk");
  v.number("way_m", c.way_m, 10, 1e5, "m", "length of the drive");
  v.number("speed_mps", c.speed_mps, 0.05, 20, "m/s", "speed of the car");
  v.number("turn_radius_m", c.turn_radius_m, 1, 50, "m", "turning radius of the car at full lock");
  v.check(c.trunk_width_min_m <= c.trunk_width_max_m, "trunk_width_min_m",
          "must not be above trunk_width_max_m");
}

}  // namespace orchard::simulation
