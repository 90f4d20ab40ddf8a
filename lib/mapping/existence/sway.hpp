// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Tells stalks of grass and twigs that sway in the wind from thin objects that stand.
///
/// The observations of a standing object scatter by the errors of detections and poses. Poses may
/// be worse than they state, so the scatter is compared with that of this map's trees.
class SwayTest {
 public:
  explicit SwayTest(const MapState& map);

  /// Whether a landmark may be a stalk (flicker.hpp) and its observations scatter by more than
  /// those of a standing object would in one case of a thousand (chi-square test).
  bool sways(const LandmarkRecord& record) const;

 private:
  const MapState& map_;
  double excess_ = 1.0;  ///< median chi-square of trees per degree of freedom, at least 1
};

}  // namespace orchard::mapping
