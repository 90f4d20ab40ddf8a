// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "geometry/pose2.hpp"
#include "mapping/compare/map_alignment.hpp"

namespace orchard::mapping {

/// A map merged from several maps of one orchard.
struct MergedMap {
  std::vector<Landmark> landmarks;  ///< in the frame of the first map, in order of id
  std::int32_t next_id = 1;         ///< first id not used by any of them
};

/// Id of an input landmark in the merged map.
struct MergedId {
  std::int32_t before = 0;
  std::int32_t now = 0;
};

/// Merges map b into `merged`, using the `alignment` of merged and b.
///
/// Coincident landmarks are united: number of observations and mean roc over all observations;
/// standard errors as of one sample (Chan et al. 1979, from each map's n, mean and standard error);
/// position and width weighted by their uncertainty; class and probability by the sum of the log
/// odds, each clamped to the precision of files. Landmarks without any observation keep 0. Ids of
/// `merged` are kept; new landmarks get ids from merged.next_id on, in order of their id in b. Row
/// and position of `merged` are kept; they are 0 for new landmarks. Returns the ids of b's
/// landmarks, in order.
std::vector<MergedId> merge_into(MergedMap& merged, const std::vector<Landmark>& b,
                                 const MapAlignment& alignment);

/// Transforms a landmark from frame b to frame a: position, standard errors and covariance.
Landmark transformed(const Landmark& b, const geometry::Pose2& T_a_b);

/// Unites two landmarks of one object, both in one frame; keeps id, row and position of `a`.
/// Positions are weighted by `a.covariance` and `b.covariance` where known.
Landmark merged_landmark(const Landmark& a, const Landmark& b);

}  // namespace orchard::mapping
