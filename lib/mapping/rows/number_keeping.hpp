// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/compare/map_alignment.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// How many things a new map has in common with the one whose ids it takes.
struct KeptNumbers {
  int num_found = 0;           ///< landmarks that were found again, and keep their ids
  int num_gone = 0;            ///< of the earlier map that were not
  int num_new = 0;             ///< with new ids
  int num_without_number = 0;  ///< trees in a row for which no number is free at their place
};

/// Gives landmarks of a new map that stand where an earlier map (`alignment` of earlier and new)
/// had some the ids of those, and all others ids from `next_id` on, in order of their own; sorts
/// them by id. A tree beside the place of one that has gone is another where place and width say so
/// (compare_maps()).
KeptNumbers keep_ids(const std::vector<Landmark>& earlier, const MapAlignment& alignment,
                     std::int32_t& next_id, std::vector<Landmark>& landmarks);

/// Numbers a map so that no number of an earlier one is given to another tree.
///
/// `rows`: as find_rows() has them for `landmarks`, whose ids are the earlier map's already. Trees
/// found again keep row and position, even where find_rows() would count differently now. A new
/// tree takes the number of the place it stands at: that of a gap, or beyond its row's end. Where
/// none is free (between two neighbours, or before number 1) it has a row and no position. A row
/// without any known tree gets the next number above all there were. What is known but stands in no
/// row any more keeps its numbers. Rows come out in order of number.
void keep_numbers(const std::vector<Landmark>& earlier, std::vector<Row>& rows,
                  std::vector<Landmark>& landmarks, KeptNumbers& kept);

/// The rows of a map that is numbered already: as find_rows() has them, with the numbers that its
/// trees have; a tree of a row that has none gets one. None where no landmark has a number.
std::vector<Row> rows_as_numbered(std::vector<Landmark>& landmarks, const RowsConfig& config);

}  // namespace orchard::mapping
