// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// How much each tree has to say about where rows are: its confidence (probability times roc_mean)
/// over half of the map's median. From 1 on that is full strength; posts and parts of bushes that
/// pass for trees have less.
std::vector<double> row_strengths(const std::vector<const Landmark*>& trees);

/// The trees that may begin and join rows: those of full strength that stand alone in their place.
/// Of several within a third of the spacing (a bush, two stems) only the strongest does; `rest` are
/// those too weak, of which each stands alone, too.
struct RowMakers {
  std::vector<std::size_t> makers;
  std::vector<std::size_t> rest;
};
RowMakers row_makers(const std::vector<Eigen::Vector2d>& p_map,
                     const std::vector<double>& strengths);

/// Puts the trees of indices `rest` into the chains in whose line they stand, between two of a
/// chain's or beyond its ends by up to a spacing and a half; the others stay out. `rows` has the
/// directions of all.
void join_chains(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows,
                 const std::vector<std::size_t>& rest, std::vector<RowChain>& chains);

/// Makes one chain of two where one ends beside the beginning of the other, in its line: what broke
/// the row there stands between its places. Their trees in order along the row.
void mend_chains(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows,
                 std::vector<RowChain>& chains);

/// Those of a chain that stand in its places, whole spacings apart: what stands between two places
/// is a post or a bush. The set that has most strength for least deviation from the spacing of
/// those of full strength.
RowChain in_places(const std::vector<Eigen::Vector2d>& p_map, const std::vector<double>& strengths,
                   const RowChain& chain);

}  // namespace orchard::mapping
