// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace orchard::mapping
