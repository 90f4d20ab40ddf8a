// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace orchard::calibration {

/// One width of one of several trunks.
struct SpotObservation {
  int thing = 0;
  double range_m = 0.0;
  double beam_step_rad = 0.0;
  double width_m = 0.0;
};

/// How widths grow with range: what a beam's divergence adds to all trunks alike.
struct SpotGrowth {
  double divergence_rad =
      0.0;  ///< m of width per m of range, beside what the rig takes off already
  double se_rad = 0.0;

  bool significant() const;
};

/// Fits width = its trunk's own + divergence x range, by least squares weighted as counts of beams
/// are known. What the spot is wide as it leaves cannot be told from the trunks being thicker.
///
/// Takes only observations of which a trunk of that width always meets more than `fewest_beams`:
/// farther off, those that make it too narrow are missing. None where ranges or observations are
/// too few to tell.
std::optional<SpotGrowth> spot_growth(const std::vector<SpotObservation>& observations,
                                      int fewest_beams);

}  // namespace orchard::calibration
