// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera_config.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/scene/world.hpp"
#include "simulation/sensor/laser_model.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// Computes the true observations of one scan: of every object in `truth` that is within range and
/// fills at least one beam step of the field of view, hidden ones included, in the order of
/// `truth`.
///
/// Computed from angular intervals, not from rays, so that it does not repeat the errors of
/// simulate_scan. T_map_laser: one pose, or one per beam; world and truth are those of the middle
/// of the sweep. Leaves utime 0. Overlapping shapes of which neither is entirely in front of the
/// other are ordered by their ranges in the middle of the shared angle. Throws
/// std::invalid_argument for any other number of poses.
std::vector<TrueObservation> observe_truth(const World& world,
                                           const std::vector<TruthObject>& truth,
                                           const std::vector<Pose2>& T_map_laser,
                                           const ScannerConfig& scanner,
                                           const geometry::CameraConfig& camera,
                                           const Tilt& tilt = {});

}  // namespace orchard::simulation
