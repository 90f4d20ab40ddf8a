// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "geometry/pose2.hpp"
#include "mapping/compare/map_alignment.hpp"

namespace orchard::mapping {

/// Several maps of one orchard as one.
struct MergedMap {
  std::vector<Landmark> landmarks;  ///< in the frame of the first map, in order of id
  std::int32_t next_id = 1;         ///< first id that none of them ever had
};

/// The id that a landmark of an input has in the merged map.
struct KeptId {
  std::int32_t before = 0;
  std::int32_t now = 0;
};

/// Takes map b into `merged`, which it is laid on by `alignment` (of merged and b).
///
/// Things that lie upon each other become one: n and mean roc of all observations; standard errors
/// of all observations as of one sample (Chan et al. 1979, from each map's n, mean and standard
/// error); position and width weighted by what each map knows of them; class and probability by the
/// sum of the log odds, each within what files can hold. A thing that no map held an observation of
/// keeps 0. Ids are those of `merged`; what is new gets merged.next_id and on, in order of its id
/// in b. Row and position stay as `merged` has them; of new things they are 0. Returns the ids of
/// b, in its order.
std::vector<KeptId> merge_into(MergedMap& merged, const std::vector<Landmark>& b,
                               const MapAlignment& alignment);

/// A landmark of frame b as it is in frame a: place, standard errors and covariance turned.
Landmark transformed(const Landmark& b, const geometry::Pose2& T_a_b);

/// One landmark of two maps of which it is the same thing, both in one frame; id, row and position
/// of `a`. `a.covariance` and `b.covariance` weigh the places where they are known.
Landmark united(const Landmark& a, const Landmark& b);

}  // namespace orchard::mapping
