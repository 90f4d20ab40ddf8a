// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "geometry/camera_model.hpp"
#include "laser/laser_config.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// The parts of a rig's configuration that the simulation needs.
struct RigConfig {
  laser::LaserConfig laser;
  geometry::CameraConfig camera;
  SimulationConfig simulation;
  laser::RearLaserConfig laser_rear;  ///< the rear scanner; measures with the same errors
};

/// Makes the paper's simulated environment (Shalal et al. 2013, sections 3.4 and 6.1, figures 3,
/// 11): tubes T1-T6 left and T7-T12 right of the robot's path along map +Y, which begins at the
/// origin midway between the rows; B1, B3, B4 of 170 mm and B2, a tube of another colour, between
/// and outside the rows. The truth has the names. Objects are placed so that every tube and object
/// is in 5 to 8 pairs within 4 m, in the camera's view and unoccluded (where the configured
/// geometry allows it). The room's walls are beyond the scanner's range: only the camera sees them.
Scene make_tube_scene(std::uint64_t seed, const RigConfig& rig);

/// For each truth[i] of a stepped scene, the number of pairs in which it is within range, entirely
/// in the camera's view at the scan plane, and unoccluded.
std::vector<int> count_pairs(const Scene& scene, const RigConfig& rig, double range_max_m);

}  // namespace orchard::simulation
