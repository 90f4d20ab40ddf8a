// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Evidence that a chain of trees was planted as a row.
struct RowEvidence {
  double log_odds = 0.0;  ///< of being planted, for the contiguous part with most evidence
  std::size_t first = 0;  ///< index of the first tree that belongs to the row
  std::size_t last = 0;   ///< index of the last one, inclusive
};

/// Log odds that a chain was planted: steps of a planted row are whole spacings, mostly single
/// ones; steps of other objects have any length. `orchard_spacing_m`: spacing of the other rows, 0
/// if unknown; a chain with another spacing needs one step more.
RowEvidence row_evidence(const std::vector<Eigen::Vector2d>& p_map, const RowChain& chain,
                         double orchard_spacing_m);

/// Removes chains that are not rows: those whose steps are irregular, and those too close to a more
/// certain row for the row distance of this orchard. Removes hedges, bushes and objects in line by
/// chance.
void drop_irregular_chains(const std::vector<Eigen::Vector2d>& p_map,
                           std::vector<RowChain>& chains);

}  // namespace orchard::mapping
