// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Distinguishes stems from foliage by the scatter of a landmark's observations: a stem is hit at
/// the same position from every side, foliage at varying depth.
///
/// The limit is the scatter of the trees in the map's own rows, which depends on scanner, poses and
/// trunks. Without such trees, no landmark is a sharp stem.
class StemScatterTest {
 public:
  explicit StemScatterTest(const std::vector<Landmark>& landmarks);

  /// Whether a landmark is a tree that scatters no more than the trees of rows.
  bool contains(const Landmark& landmark) const;

 private:
  double scatter_max_m_ = 0.0;
};

}  // namespace orchard::mapping
