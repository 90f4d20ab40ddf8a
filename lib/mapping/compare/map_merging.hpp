// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// Statistics of keeping ids and numbers of an earlier map.
struct IdTransfer {
  int num_found = 0;           ///< landmarks found again, which keep their ids
  int num_gone = 0;            ///< landmarks of the earlier map not found again
  int num_new = 0;             ///< landmarks with new ids
  int num_without_number = 0;  ///< new trees in a row for whose slot no number is free
};

/// Transfers ids from an earlier map to a new one, using the `alignment` of the two. Landmarks at
/// positions of earlier ones get their ids; all others get ids from `next_id` on, in order of their
/// previous ids. Sorts the landmarks by id. A tree planted beside a missing one is recognised by
/// position and width (compare_maps()).
IdTransfer keep_ids(const std::vector<Landmark>& earlier, const MapAlignment& alignment,
                    std::int32_t& next_id, std::vector<Landmark>& landmarks);

/// Numbers the rows of a map so that no number of an earlier map is given to another tree.
///
/// `rows`: result of find_rows() for `landmarks`, which already have the earlier map's ids. Trees
/// found again keep row and position, even where find_rows() would count differently. A new tree
/// takes the number of its slot: in a gap, or beyond the end of the row. If none is free (between
/// two neighbours, or before number 1), it has a row but no position. A row without known trees
/// gets the next unused row number. Known trees that are in no row any more keep their numbers.
/// The rows of the result are numbered_rows(landmarks).
void keep_numbers(const std::vector<Landmark>& earlier, std::vector<Row> rows,
                  std::vector<Landmark>& landmarks, IdTransfer& kept);

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
/// position, width and height weighted by their uncertainty; class and probability by the sum of
/// the log odds, each clamped to the precision of files. Landmarks without any observation keep 0.
/// Ids of `merged` are kept; new landmarks get ids from merged.next_id on, in order of their id in
/// b. Row and position of `merged` are kept; they are 0 for new landmarks. Returns the ids of b's
/// landmarks, in order.
std::vector<MergedId> merge_into(MergedMap& merged, const std::vector<Landmark>& b,
                                 const MapAlignment& alignment);

/// Landmarks with heights above an origin that is lower by `raise_m`; none: nobody knows by how
/// much, and the heights become unknown.
std::vector<Landmark> raised(std::vector<Landmark> landmarks, const std::optional<double>& raise_m);

/// Transforms a landmark from frame b to frame a: position, standard errors and covariance.
Landmark transformed(const Landmark& b, const geometry::Pose2& T_a_b);

/// Unites two landmarks of one object, both in one frame; keeps id, row and position of `a`.
/// Positions are weighted by `a.covariance` and `b.covariance` where known.
Landmark merged_landmark(const Landmark& a, const Landmark& b);

}  // namespace orchard::mapping
