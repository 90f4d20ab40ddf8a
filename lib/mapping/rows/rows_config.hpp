// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace orchard::mapping {

enum class RowNumbering {
  kAutomatic,  ///< positions count towards +y (or +x for rows along x), rows from the left
  kOrigin,     ///< row 1, position 1 lie at the corner nearest to origin_m
  kDirection,  ///< positions count towards forward_deg, rows from the left
};

/// How trees are grouped into numbered rows. Section `mapper.rows`.
struct RowsConfig {
  bool enabled = true;
  RowNumbering numbering = RowNumbering::kAutomatic;
  std::array<double, 2> origin_m{0.0, 0.0};
  double forward_deg = 90.0;
  int first_row = 1;
  int first_position = 1;
};

template <class Visitor>
void describe(Visitor& v, RowsConfig& c) {
  v.flag("enabled", c.enabled, "find rows of trees and number rows and trees");
  v.choice("numbering", c.numbering, {"automatic", "origin", "direction"},
           "start of the numbers: by the axes of the map, at the corner nearest to origin_m, or "
           "along forward_deg");
  v.numbers("origin_m", c.origin_m, -1e7, 1e7, "m",
            "numbering: origin: corner where the numbers start, in the map frame");
  v.number("forward_deg", c.forward_deg, -360, 360, "deg",
           "numbering: direction: direction of increasing tree numbers, from map x towards y");
  v.expert().integer("first_row", c.first_row, 1, 100000, "1", "number of the first row");
  v.expert().integer("first_position", c.first_position, 1, 100000, "1",
                     "number of the first tree of a row");
}

}  // namespace orchard::mapping
