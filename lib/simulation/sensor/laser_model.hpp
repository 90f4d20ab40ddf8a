// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/scan.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/sensor/ray_fan.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// Draws the constant range errors of a world's targets, as fractions of the range.
std::vector<double> draw_target_errors(int num_targets, const ScannerConfig& scanner,
                                       Random& random);

/// Tilt of the scan plane during a sweep; 0 on level ground.
struct Tilt {
  double pitch_rad = 0.0;  ///< nose down
  double roll_rad = 0.0;   ///< left side up
};

/// Simulates one sweep through a world: ray casting with a finite spot, mixed pixels, the errors of
/// ScannerConfig, resolution of whole millimetres. The world is that of the middle of the sweep. A
/// tilted plane meets the ground; the effect of tilt on the height at which objects are cut is
/// neglected.
///
/// T_map_laser holds one pose, or one per beam for a scanner that moves while it sweeps.
/// `target_errors` may be empty (none). Leaves utime and seq 0. Throws std::invalid_argument for
/// any other number of poses.
laser::Scan simulate_scan(const World& world, const std::vector<Pose2>& T_map_laser,
                          const ScannerConfig& scanner, const std::vector<double>& target_errors,
                          Random& random, const Tilt& tilt = {});

/// The same above ground that is not level: beams in space meet leaning and tapering trunks where
/// they pass them, the ground, and grass.
laser::Scan simulate_scan(const World& world, const UnevenSweep& sweep,
                          const ScannerConfig& scanner, const std::vector<double>& target_errors,
                          Random& random);

/// Simulates a sweep without errors: the distance along every beam's axis, not rounded.
laser::Scan simulate_perfect_scan(const World& world, const Pose2& T_map_laser,
                                  const ScannerConfig& scanner);

}  // namespace orchard::simulation
