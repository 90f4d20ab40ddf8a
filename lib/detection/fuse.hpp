// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/detection.hpp"

namespace orchard::detection {

/// roc_edges = (left + right + parallel) / 3. Source: Shalal et al. 2013, figure 9.
double fuse_edges(double roc_left_edge, double roc_right_edge, double roc_parallel);

/// roc_vision = w colour + (1 - w) edges. Source: Shalal et al. 2013, section 6.2: w = 0.6 gives
/// the paper's 0.822 from its averages 0.9 and 0.705.
double fuse_vision(double roc_colour, double roc_edges, double colour_weight);

/// roc_tree = w laser + (1 - w) vision. Source: Shalal et al. 2013, figure 4 and table 2 (object
/// B2, whose colour failed: 0.461 = 0.5 x its roc_laser).
double fuse_tree(double roc_laser, double roc_vision, double laser_weight);

/// TREE if roc_tree is at least the threshold, otherwise OBJECT.
inline Label label_of(double roc_tree, double tree_threshold) {
  return roc_tree >= tree_threshold ? Label::kTree : Label::kObject;
}

}  // namespace orchard::detection
