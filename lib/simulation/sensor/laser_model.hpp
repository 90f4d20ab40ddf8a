// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "laser/scan.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// The lasting range errors of a world's targets, as fractions of the range.
std::vector<double> draw_target_errors(int num_targets, const ScannerConfig& scanner,
                                       Random& random);

/// How the scan plane lies during a sweep: on level ground, level.
struct Tilt {
  double pitch_rad = 0.0;  ///< nose down
  double roll_rad = 0.0;   ///< left side up
};

/// One sweep of the scanner through a world: ray casting with a finite spot, mixed pixels, the
/// errors of ScannerConfig, whole millimetres. The world is that of the middle of the sweep. A
/// tilted plane meets the ground; that it meets things a little higher or lower is left out.
///
/// T_map_laser holds one pose, or one per beam for a scanner that moves while it sweeps.
/// `target_errors` may be empty (none). Leaves utime and seq 0.
/// Throws std::invalid_argument for any other number of poses.
laser::Scan simulate_scan(const World& world, const std::vector<Pose2>& T_map_laser,
                          const ScannerConfig& scanner, const std::vector<double>& target_errors,
                          Random& random, const Tilt& tilt = {});

/// The same without any error: the distance along every beam's axis, not rounded.
laser::Scan simulate_perfect_scan(const World& world, const Pose2& T_map_laser,
                                  const ScannerConfig& scanner);

/// A bench for width measurements: one upright cylinder, its axis range_m + radius away (so that
/// its nearest surface is range_m away) at a random bearing within +-60 degrees.
laser::Scan simulate_trunk_scan(double diameter_m, double range_m, const ScannerConfig& scanner,
                                Random& random);

}  // namespace orchard::simulation
