// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "mapping/candidate.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/mapper_config.hpp"

namespace orchard::mapping {

/// Max gap between touching borders [m]: scanners do not see through it, and nobody passes.
inline constexpr double kTouch_m = 0.15;

/// Extent of a landmark from its position [m]: half its width; for a clump (a bush, whose leaves
/// are hit differently by each scan) at least the extent of its observations.
double extent_radius_m(const LandmarkRecord& record);

/// Index of the landmark that forms one clump with landmark `index`: both are certainly not trees,
/// and their borders touch; or one is rather not a tree and overlaps the other. The clump is at
/// most `object_width_max_m` wide; larger objects stay several landmarks until map files are
/// written (long_objects.hpp). -1 if there is none.
std::int32_t touching_clump(const LandmarkTable& landmarks, std::int32_t index,
                            const MapperConfig& config);

/// Whether a detection is rather a tree than not, judged by the camera, or by the laser if no image
/// shows it. Trees in a bush are not parts of it.
bool looks_like_a_tree(const detection::Detection& detection);

/// Index of the clump that a candidate which does not look like a tree is part of; -1 if there is
/// none.
std::int32_t clump_around(const LandmarkTable& landmarks, const Candidate& candidate,
                          const MapperConfig& config);

}  // namespace orchard::mapping
