// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

enum class RowNumbering {
  kNone,       ///< no rows are looked for
  kAutomatic,  ///< positions count towards +y (or +x for rows along x), rows from the left
  kOrigin,     ///< row 1, position 1 lie at the corner nearest to origin_m
  kDirection,  ///< positions count towards forward_deg, rows from the left
};

/// How trees are grouped into numbered rows. Section `mapper.rows`.
struct RowsConfig {
  RowNumbering numbering = RowNumbering::kAutomatic;
  std::array<double, 2> origin_m{0.0, 0.0};
  double forward_deg = 90.0;
  int first_row = 1;
  int first_position = 1;

  bool has_rows() const { return numbering != RowNumbering::kNone; }
};

template <class Visitor>
void describe(Visitor& v, RowsConfig& c) {
  v.choice("numbering", c.numbering, {"none", "automatic", "origin", "direction"},
           "where the numbers of rows and trees start: by the axes of the map, at the corner "
           "nearest to origin_m, or along forward_deg; none = no rows are looked for");
  v.numbers("origin_m", c.origin_m, -1e7, 1e7, "m",
            "numbering: origin: corner where the numbers start, in the map frame");
  v.number("forward_deg", c.forward_deg, -360, 360, "deg",
           "numbering: direction: direction of increasing tree numbers, from map x towards y");
  v.expert().integer("first_row", c.first_row, 1, 100000, "1", "number of the first row");
  v.expert().integer("first_position", c.first_position, 1, 100000, "1",
                     "number of the first tree of a row");
}

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

/// The names of rows that are not named by their number, by number.
using RowNames = std::map<std::int32_t, std::string>;

/// The name of a row: its own, or its number after `prefix`.
std::string row_name(const RowNames& names, std::int32_t row, const std::string& prefix = {});

/// derived: Gaps of more slots end a row: beyond, nothing tells that both parts are one.
inline constexpr int kGapMax_slots = 8;

/// Finds the rows of a map, straight or curved, and numbers rows and slots.
///
/// Uses only trees. Empty slots are counted too, so that numbers do not change when a tree dies or
/// is planted: inside a row by the local spacing, before its first tree by the starts of the
/// neighbouring rows. Rows are in order of number; the result does not depend on the order of the
/// landmarks. If trees are aligned in two directions, the one with the shorter spacing is the row
/// direction. None with numbering kNone.
std::vector<Row> find_rows(const std::vector<Landmark>& landmarks, const RowsConfig& config);

/// Sets the probability that each landmark is a tree by its place in the order of the rows; at
/// least two rows are needed, one alone may be a fence.
///
/// A row goes on beyond its last tree if something else stands where the next one would. For an
/// object d trees from the end of a row to be none, this must have happened d + 1 times.
void set_probability_by_order(const std::vector<Row>& rows, std::vector<Landmark>& landmarks);

/// Sets row and position of the landmarks in `rows`; 0 for all others.
void number_landmarks(const std::vector<Row>& rows, std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
