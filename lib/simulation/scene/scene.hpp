// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/world.hpp"

namespace orchard::simulation {

enum class SceneKind { kTubes, kOrchard, kPark, kYard };

/// Appearance of a surface.
struct Appearance {
  enum class Texture { kCardboard, kBark, kLeaves, kRoughBark, kWood };
  double hue_deg = 30.0;
  double saturation = 0.45;
  double value = 0.65;
  Texture texture = Texture::kCardboard;
  std::uint32_t texture_seed = 0;
  double reflectivity = 0.3;  ///< to the laser; 1: white paper, more: a reflector
};

struct Limits {
  double min, max;
};

/// Draws the hue [deg], saturation and value of a surface, in this order.
inline Appearance draw_appearance(Random& random, Limits hue_deg, Limits saturation, Limits value,
                                  Appearance::Texture texture = Appearance::Texture::kCardboard) {
  Appearance appearance;
  appearance.hue_deg = random.uniform(hue_deg.min, hue_deg.max);
  appearance.saturation = random.uniform(saturation.min, saturation.max);
  appearance.value = random.uniform(value.min, value.max);
  appearance.texture = texture;
  return appearance;
}

/// A cylinder on the ground, level cuts of which are circles: a tube, a trunk, a post, a twig.
struct Cylinder {
  double x_m = 0.0;  ///< map frame
  double y_m = 0.0;
  double radius_m = 0.0;
  double height_m = 0.0;
  double base_m = 0.0;  ///< height at which it begins
  int target = 0;       ///< cylinders of one target share its constant range error; -1: scenery
  Appearance appearance;
  double lean_x = 0.0;  ///< lean of its axis, metres per metre of height; x_m, y_m: at scan height
  double lean_y = 0.0;
  double sway_m = 0.0;          ///< amplitude of its motion about its position
  double leaf_depth_m = 0.0;    ///< mean penetration depth of beams; 0: solid
  double velocity_x_mps = 0.0;  ///< during a scan
  double velocity_y_mps = 0.0;
  double taper = 0.0;  ///< decrease of its radius per metre of height; radius_m: at scan height
};

/// An upright box on the ground: a crate, a part of a wall or hedge, a fallen branch.
struct Box {
  double x_m = 0.0;  ///< of its centre, map frame
  double y_m = 0.0;
  double yaw_rad = 0.0;   ///< of its length
  double length_m = 0.0;  ///< along its own x
  double width_m = 0.0;   ///< along its own y
  double height_m = 0.0;
  double base_m = 0.0;  ///< height at which it begins
  int target = 0;       ///< see Cylinder
  Appearance appearance{};
};

/// Crown of leaves above a trunk, a ball for the camera; lasers do not reach it.
struct Crown {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;  ///< of its centre above the ground
  double radius_m = 0.0;
  double foliage = 0.5;  ///< fraction filled by leaves
  Appearance appearance;
};

/// What stands, then goes straight on: a person (two legs in the scan plane, a body above them), or
/// a small tractor (four wheels in the scan plane, a body above them).
struct Mover {
  enum class Kind { kPerson, kVehicle };
  Kind kind = Kind::kPerson;
  double x_m = 0.0;  ///< of its centre until `starts_s`, map frame
  double y_m = 0.0;
  double heading_rad = 0.0;
  double starts_s = 0.0;  ///< time of the run
  double speed_mps = 0.0;
  int target = 0;
  Appearance clothes;
};

/// Everything visible to sensors. A target is the index of an object in the scene's truth.
struct World {
  std::vector<Cylinder> cylinders;
  std::vector<Box> boxes;
  std::vector<Crown> crowns;
  int num_targets = 0;
  bool indoors = true;             ///< floor and walls, or grass, far trees and sky
  double light_azimuth_rad = 2.0;  ///< direction to the light source, map frame
  double light_elevation_rad = 0.7;
  double ambient = 0.55;  ///< fraction of diffuse light
  std::uint32_t texture_seed = 0;
};

/// A world, its truth, and the motion of the robot.
struct Scene {
  World world;  ///< the static objects
  std::vector<Mover> movers;
  std::vector<TruthObject> truth;  ///< moving objects are last, in the order of `movers`
  std::vector<TruthObject> gaps;   ///< empty positions of the rows, with their missing trees
  /// For every target its number before change_orchard(); empty when nothing was changed.
  std::vector<int> former_targets;
  bool stepped = false;      ///< true: stops at `stops` for every pair; false: drives along `path`
  std::vector<Pose2> stops;  ///< T_map_base
  double stop_period_s = 1.0;
  DrivePath path;

  /// Adds an object of one cylinder with its truth.
  void add(Cylinder cylinder, detection::Label label, const std::string& name) {
    cylinder.target = world.num_targets++;
    truth.push_back({label, cylinder.x_m, cylinder.y_m, 2.0 * cylinder.radius_m, name});
    world.cylinders.push_back(cylinder);
  }

  /// Adds a bush with its truth: an irregular cluster of twigs of random height, `leaf()` gives the
  /// appearance of each.
  template <class Leaf>
  void add_bush(double x_m, double y_m, double size_m, Limits height_m, const std::string& name,
                Random& place, Leaf leaf) {
    const int target = world.num_targets++;
    const int num_twigs = static_cast<int>(40 * size_m);
    for (int i = 0; i < num_twigs; ++i) {
      const double distance_m = 0.5 * size_m * std::sqrt(place.uniform());
      const double angle_rad = place.uniform(0.0, 2.0 * geometry::kPi);
      const double twig_x_m = x_m + distance_m * std::cos(angle_rad);
      const double twig_y_m = y_m + distance_m * std::sin(angle_rad);
      const double radius_m = place.uniform(0.012, 0.05);
      world.cylinders.push_back({twig_x_m, twig_y_m, radius_m,
                                 place.uniform(height_m.min, height_m.max), 0.0, target, leaf()});
    }
    truth.push_back({detection::Label::kObject, x_m, y_m, size_m, name});
  }

  /// True if no object of the truth is within `reach_m` of a point, beyond its own half width.
  bool is_clear(double x_m, double y_m, double reach_m) const {
    return std::none_of(truth.begin(), truth.end(), [&](const TruthObject& other) {
      return std::hypot(other.x_m - x_m, other.y_m - y_m) < reach_m + 0.5 * other.width_m;
    });
  }
};

}  // namespace orchard::simulation
