// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/scene/terrain.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

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

inline constexpr double kRowsBegin_m = 4.0;  ///< from the robot's start to the first trees, map y

/// Makes the path through an orchard: up and down every aisle from the map's origin, with half
/// circles beyond the ends of the rows. With `laps` it returns along the headland to the origin and
/// repeats; only then `start_anywhere` and section `carry` take effect.
DrivePath make_orchard_path(std::uint64_t seed, const OrchardConfig& config,
                            const CarryConfig& carry);

/// Makes an orchard: rows of trees along map y, unevenly spaced, some missing; posts and bushes in
/// the rows; a robot on the path of make_orchard_path().
Scene make_orchard_scene(std::uint64_t seed, const OrchardConfig& config,
                         const CarryConfig& carry = {});

/// Adds the objects of `config.clutter` to an orchard of trees, trellis posts and bushes. Moves no
/// existing object and keeps clear of the robot's path; moving objects are last in the truth.
void add_clutter(std::uint64_t seed, const SimulationConfig& config, Scene& scene);

/// Changes an orchard to a later day: trees felled, planted in empty positions, moved, grown. All
/// other objects stay unchanged; truth and targets are renumbered.
void change_orchard(std::uint64_t seed, const ChangeConfig& config, Scene& scene);

/// Tapers the trunks of a scene and adds the branches of `config.terrain` near the height of the
/// scan; they are not in the truth.
void grow_low_branches(std::uint64_t seed, const SimulationConfig& config, Scene& scene);

/// Gives the objects of a scene's truth the height of the ground beneath them.
void stand_on_terrain(const Terrain& terrain, Scene& scene);

/// Makes a park: trees of all widths, in groups and alone, and bushes, all clear of the path of a
/// car that visits random waypoints, half of them again from another side.
Scene make_park_scene(std::uint64_t seed, const ParkConfig& config);

/// Makes a yard between blocks: a small block of rows, a shed with a lean-to and objects beside it,
/// hedges with rough faces, scattered trees; a path of 1.5 km that revisits most places from both
/// sides. Only the trees are in the truth as trees; walls, hedges and crates are scenery.
Scene make_yard_scene(std::uint64_t seed, const YardConfig& config);

}  // namespace orchard::simulation
