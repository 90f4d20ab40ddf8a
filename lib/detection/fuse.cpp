// SPDX-License-Identifier: BSD-3-Clause
#include "detection/fuse.hpp"

namespace orchard::detection {

double fuse_edges(double roc_left_edge, double roc_right_edge, double roc_parallel) {
  return (roc_left_edge + roc_right_edge + roc_parallel) / 3.0;
}

double fuse_vision(double roc_colour, double roc_edges, double colour_weight) {
  return colour_weight * roc_colour + (1.0 - colour_weight) * roc_edges;
}

double fuse_tree(double roc_laser, double roc_vision, double laser_weight) {
  return laser_weight * roc_laser + (1.0 - laser_weight) * roc_vision;
}

}  // namespace orchard::detection
