// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// What the steps of a chain say of it.
struct RowEvidence {
  double log_odds = 0.0;  ///< that it was planted, of the part that speaks most for it
  std::size_t first = 0;  ///< of its trees: what lies before stands elsewhere
  std::size_t last = 0;   ///< and what lies beyond; inclusive
};

/// Log odds that what stands in line was planted: its steps are whole spacings, most of them single
/// ones, where things that merely stand there have steps of any length. `orchard_spacing_m`: what
/// the other rows show, 0 for unknown; a chain of another spacing has to show its own first.
RowEvidence row_evidence(const std::vector<Eigen::Vector2d>& p_map, const RowChain& chain,
                         double orchard_spacing_m);

/// Leaves those chains that are rows: whose steps say so, and which do not stand between rows that
/// are surer, nearer to one than rows of this orchard are to each other. Hedges, bushes and what
/// else stands in line by chance go.
void keep_planted(const std::vector<Eigen::Vector2d>& p_map, std::vector<RowChain>& chains);

}  // namespace orchard::mapping
