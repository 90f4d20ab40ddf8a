// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

#include "simulation/scene/scene.hpp"
#include "simulation/scene/terrain.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

inline constexpr double kNoHit = std::numeric_limits<double>::infinity();

/// What a ray meets first.
struct Hit {
  double range_m = kNoHit;
  int target = -1;
  double strength = 0.0;  ///< reflectivity times the cosine of incidence
};

/// A sweep above ground that is not level. T_map_laser: one pose, or one per beam.
struct UnevenSweep {
  const Terrain& terrain;
  double grass_height_m = 0.0;
  std::vector<Eigen::Isometry3d> T_map_laser;
};

/// The first hit of every ray of every beam of a sweep.
class RayFan {
 public:
  /// A level sweep. T_map_laser: one pose, or one per beam. `num_rays`: per beam, across its spot.
  /// `leaf_bits`: random bits for the penetration of beams into leaves.
  RayFan(const std::vector<Pose2>& T_map_laser, const ScannerConfig& scanner, int num_rays,
         std::uint64_t leaf_bits = 0);

  /// A sweep through objects that stand on ground that is not level.
  RayFan(const UnevenSweep& sweep, const ScannerConfig& scanner, int num_rays,
         std::uint64_t leaf_bits);

  void add(const World& world);

  /// The hits of a beam's rays.
  const Hit* beam(int index) const { return &hits_[static_cast<std::size_t>(index) * num_rays_]; }

 private:
  /// A ray of a beam's spot: the rays start side by side and diverge.
  struct Ray {
    double dx = 1.0, dy = 0.0, dz = 0.0;     ///< direction in map
    double x_m = 0.0, y_m = 0.0, z_m = 0.0;  ///< start point, in map
  };
  /// The part of a ray that is inside an object.
  struct Span {
    double enter_m = kNoHit;
    double leave_m = 0.0;
  };
  /// Where an object may be met, from the scanner in the middle of the sweep.
  struct Bearing {
    double bearing_rad;
    double distance_m;
    double radius_m;
    double spread_rad = 0.0;  ///< of the bearing, as the scan plane turns
  };

  void add(const Cylinder& cylinder);
  void add(const Box& box);
  void cast(const Cylinder& cylinder, double ground_m, int beam);
  void cast(const Box& box, double ground_m, int beam);

  Bearing bearing_of(double x_m, double y_m, double radius_m) const;
  Bearing uneven_bearing_of(const Cylinder& outline, double ground_m) const;
  template <class Function>
  void for_each_beam(const Bearing& to, const Function& function) const;

  double time_s(int beam) const;
  Ray ray_of(int beam, int ray) const;
  Ray uneven_ray_of(int beam, int ray) const;
  Span span_of(const Ray& ray, const Cylinder& cylinder, double ground_m) const;
  double cosine_of(const Ray& ray, const Cylinder& cylinder, double ground_m, double range_m) const;
  double leaf_depth_m(const Cylinder& cylinder, int beam) const;

  template <class Pose>
  const Pose& of_beam(const std::vector<Pose>& poses, int beam) const {
    return poses.size() == 1 ? poses[0] : poses[static_cast<std::size_t>(beam)];
  }
  Hit& hit_of(int beam, int ray) { return hits_[static_cast<std::size_t>(beam) * num_rays_ + ray]; }

  const std::vector<Pose2>* level_ = nullptr;  ///< of a level sweep
  const UnevenSweep* uneven_ = nullptr;        ///< of another
  const ScannerConfig& scanner_;
  int num_rays_;
  std::uint64_t leaf_bits_;
  std::vector<Hit> hits_;
  Pose2 middle_;
  double moved_m_ = 0.0;
  double turned_rad_ = 0.0;
};

}  // namespace orchard::simulation
