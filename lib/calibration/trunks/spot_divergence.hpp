// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace orchard::calibration {

/// One measured width of a trunk.
struct SpotWidth {
  int object = 0;
  double range_m = 0.0;
  double beam_step_rad = 0.0;
  double width_m = 0.0;
};

/// Growth of measured widths with range, common to all trunks: the effect of the beam's divergence.
struct SpotDivergence {
  /// Growth of the width per range [m/m], in addition to the rig's laser.spot_rad.
  double divergence_rad = 0.0;
  double se_rad = 0.0;

  bool significant() const;
};

/// Fits width = trunk's own width + divergence x range by weighted least squares; the weights
/// follow from the quantisation by the beam step. The constant width of the spot is not observable,
/// because thicker trunks have the same effect.
///
/// Uses only ranges at which a trunk of that width always has more than `min_beams`; at larger
/// ranges observations with too small widths are missing, which would bias the fit. None for too
/// few observations or too small a span of ranges.
std::optional<SpotDivergence> fit_spot_divergence(const std::vector<SpotWidth>& observations,
                                                  int min_beams);

}  // namespace orchard::calibration
