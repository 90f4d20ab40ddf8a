// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera_model.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/scene/world.hpp"
#include "simulation/sensor/laser_model.hpp"
#include "simulation/simulation_config.hpp"
#include "simulation/simulator.hpp"

namespace orchard::simulation {

/// True observation of one object in one scan, as in an observation CSV, from the laser's true pose
/// when its beam passed over the object.
struct TrueObservation {
  std::int64_t utime = 0;  ///< of the scan
  int object = 0;          ///< index in the truth, from 0: the line of the truth CSV
  detection::Label label = detection::Label::kTree;  ///< kTree or kObject
  double x_m = 0.0;                                  ///< map frame, in this scan
  double y_m = 0.0;
  double width_m = 0.0;
  double range_m = 0.0;          ///< to its centre, minus half its width
  double bearing_rad = 0.0;      ///< of its centre, laser frame
  int num_beams = 0;             ///< number of beams whose axes hit it
  double hidden_fraction = 0.0;  ///< fraction of its angular width behind nearer objects
  bool in_picture = false;  ///< its full width, at the height of the scan plane, is in the picture
};

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

/// True observations of scan `index` (its seq) of a simulator made with this rig: all objects of
/// the world that it could see. Throws std::invalid_argument where the ground is not level.
std::vector<TrueObservation> true_observations(const Simulator& simulator, const RigConfig& rig,
                                               std::int64_t index);

}  // namespace orchard::simulation
