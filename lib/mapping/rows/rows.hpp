// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/rows_config.hpp"

namespace orchard::mapping {

/// A slot of a row: occupied by a tree, or empty.
struct RowSlot {
  std::int32_t position = 0;     ///< number along the row
  std::int32_t landmark_id = 0;  ///< 0: empty
  Eigen::Vector2d p_map{0, 0};   ///< of the tree, or where it would stand
};

/// Trees in line.
struct Row {
  std::int32_t number = 0;
  double spacing_m = 0.0;       ///< median distance of neighbouring slots
  std::vector<RowSlot> places;  ///< in order of position; the first and last are occupied
};

/// Gaps of more slots end a row: beyond, nothing tells that both parts are one.
inline constexpr int kGapMax_slots = 8;

/// Finds the rows of a map, straight or curved, and numbers rows and slots.
///
/// Uses only trees. Empty slots are counted too, so that numbers do not change when a tree dies or
/// is planted: inside a row by the local spacing, before its first tree by the starts of the
/// neighbouring rows. Rows are in order of number; the result does not depend on the order of the
/// landmarks. If trees are aligned in two directions, the one with the shorter spacing is the row
/// direction.
std::vector<Row> find_rows(const std::vector<Landmark>& landmarks, const RowsConfig& config);

/// Sets row and position of the landmarks in `rows`; 0 for all others.
void number_landmarks(const std::vector<Row>& rows, std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
