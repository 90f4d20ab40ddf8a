// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "mapping/landmark.hpp"

namespace orchard::test {

/// A landmark of which nothing else is known.
inline mapping::Landmark landmark(std::int32_t id, detection::Label label, double x_m, double y_m,
                                  double width_m = 0.0, int num_observations = 0) {
  mapping::Landmark l;
  l.id = id;
  l.label = label;
  l.x_m = x_m;
  l.y_m = y_m;
  l.width_m = width_m;
  l.num_observations = num_observations;
  return l;
}

inline mapping::Landmark tree(std::int32_t id, double x_m, double y_m, double width_m = 0.0,
                              int num_observations = 0) {
  return landmark(id, detection::Label::kTree, x_m, y_m, width_m, num_observations);
}

}  // namespace orchard::test
