// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/rows_config.hpp"

namespace orchard::mapping {

/// A place of a row: a tree stands there, or is missing.
struct RowPlace {
  std::int32_t position = 0;     ///< number along the row
  std::int32_t landmark_id = 0;  ///< 0: a gap
  Eigen::Vector2d p_map{0, 0};   ///< of the tree, or where it would stand
};

/// Trees that stand in line.
struct Row {
  std::int32_t number = 0;
  double spacing_m = 0.0;        ///< median between neighbouring places
  std::vector<RowPlace> places;  ///< in rising position; the first and last hold trees
};

/// Finds the rows of a map, straight or curved, and numbers rows and places.
///
/// Only trees count. Places that are empty count too, so that numbers do not move when a tree
/// dies or is planted: inside a row by the local spacing, before its first tree by where the
/// neighbouring rows begin. Rows in rising number; a pure function of the landmarks' set, whatever
/// their order. Takes the shorter of two ways in which trees stand in line for the row's own.
std::vector<Row> find_rows(const std::vector<Landmark>& landmarks, const RowsConfig& config);

/// Writes row and position into the landmarks that the rows name; 0 into all others.
void number_landmarks(const std::vector<Row>& rows, std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
