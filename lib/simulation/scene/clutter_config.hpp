// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::simulation {

/// Additional objects in scene orchard. Section `simulation.clutter`. All are off by default; no
/// entry moves a tree or a post, and each kind has its own random numbers.
struct ClutterConfig {
  bool post_materials = false;
  double trunk_post_fraction = 0.0;
  double stake_fraction = 0.0;
  double twin_fraction = 0.0;
  int num_crates = 0;
  double leaf_depth_m = 0.0;
  double bush_sway_m = 0.0;
  double grass_per_tree = 0.0;
  double twigs_per_tree = 0.0;
  double sway_m = 0.0;
  int num_branches = 0;
  int num_people = 0;
  bool people_around = false;
  double person_speed_mps = 1.3;
  int num_vehicles = 0;
  double vehicle_speed_mps = 3.0;
  bool row_end_hedges = false;
  double foliage = 0.0;
  double reflector_tree_fraction = 0.0;
  double reflector_post_fraction = 0.0;
};

template <class Visitor>
void describe(Visitor& v, ClutterConfig& c) {
  v.flag("post_materials", c.post_materials,
         "true: trellis posts of steel, timber and concrete; false: of paint");
  v.number("trunk_post_fraction", c.trunk_post_fraction, 0, 1, "1",
           "additional posts as wide as a trunk, per tree place");
  v.number("stake_fraction", c.stake_fraction, 0, 1, "1",
           "fraction of trees with a stake beside them");
  v.number("twin_fraction", c.twin_fraction, 0, 1, "1",
           "fraction of trees with a second stem that touches the first");
  v.integer("num_crates", c.num_crates, 0, 1000, "1", "number of crates beside the rows");
  v.number("leaf_depth_m", c.leaf_depth_m, 0, 2, "m",
           "mean depth to which beams enter bushes of leaves; 0 = bushes of twigs");
  v.number("bush_sway_m", c.bush_sway_m, 0, 0.2, "m", "amplitude of the moving twigs of a bush");
  v.number("grass_per_tree", c.grass_per_tree, 0, 100, "1",
           "mean number of grass stalks per trunk that reach the scan plane");
  v.number("twigs_per_tree", c.twigs_per_tree, 0, 100, "1",
           "mean number of twigs per trunk that hang into the scan plane");
  v.number("sway_m", c.sway_m, 0, 0.2, "m", "amplitude of stalks and twigs in the wind");
  v.integer("num_branches", c.num_branches, 0, 1000, "1",
            "number of fallen branches at the height of the scan");
  v.integer("num_people", c.num_people, 0, 100, "1",
            "number of people who walk along and through the rows");
  v.flag("people_around", c.people_around,
         "two of three people walk beside or behind the robot, or stand until it has passed");
  v.number("person_speed_mps", c.person_speed_mps, 0.1, 3, "m/s", "speed of the people");
  v.integer("num_vehicles", c.num_vehicles, 0, 100, "1",
            "number of vehicles that stand in an alley and drive off ahead of the robot");
  v.flag("row_end_hedges", c.row_end_hedges, "hedges beyond both ends of the rows");
  v.number("foliage", c.foliage, 0, 1, "1", "fraction of a crown filled by leaves; 0 = no crowns");
  v.number("reflector_tree_fraction", c.reflector_tree_fraction, 0, 1, "1",
           "fraction of trees with a reflector band");
  v.number("reflector_post_fraction", c.reflector_post_fraction, 0, 1, "1",
           "fraction of posts with a reflector band");
}

}  // namespace orchard::simulation
