// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "mapping/candidate.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/mapper_config.hpp"

namespace orchard::mapping {

/// Borders nearer than this touch [m]: no scanner of this kind sees through, and nobody passes.
inline constexpr double kTouch_m = 0.15;

/// How far a landmark reaches from its position [m]: half its width; of a clump (a bush, which each
/// scan sees at other leaves) what its observations cover, if that is more.
double extent_radius_m(const LandmarkRecord& record);

/// The landmark that is one clump with landmark `index`: neither is a tree, and nothing passes
/// between their borders. Together they are no larger than the widest thing that a scan reports:
/// what is longer is several here, and one in the map's files (long_things.hpp). -1 for none.
std::int32_t touching_object(const LandmarkTable& landmarks, std::int32_t index,
                             const MapperConfig& config);

/// Whether what was seen is a tree rather than not, by whatever judged it: a camera, or the laser
/// alone where no picture shows it. Such a thing stands in a bush, and is no part of it.
bool looks_like_a_tree(const detection::Detection& detection);

/// The clump that a candidate, which does not look like a tree, is a part of; -1 for none.
std::int32_t clump_around(const LandmarkTable& landmarks, const Candidate& candidate,
                          const MapperConfig& config);

}  // namespace orchard::mapping
