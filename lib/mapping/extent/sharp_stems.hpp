// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Tells stems from foliage by how the observations of a landmark scatter: a stem is met at the
/// same place from every side, leaves at another depth each time.
///
/// What is sharp is the map's own: the trees of its rows scatter as its scanner, its poses and its
/// trunks do. Without such trees nothing is called sharp.
class SharpStems {
 public:
  explicit SharpStems(const std::vector<Landmark>& landmarks);

  /// Whether this is a tree that scatters no more than the trees of rows do.
  bool contains(const Landmark& landmark) const;

 private:
  double scatter_max_m_ = 0.0;
};

}  // namespace orchard::mapping
