// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace orchard::calibration {

/// One measured trunk width.
struct WidthObservation {
  double range_m = 0.0;
  double beam_step_rad = 0.0;
  double width_m = 0.0;
  int trunk = 0;
};

/// Observations of similar range.
struct WidthBin {
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  int num_observations = 0;
  double mean_m = 0.0;
  double sd_m = 0.0;
};

/// Scatter of trunk widths: sd^2 = sd_m^2 + (sd_per_beam_step x range x step)^2.
struct WidthByRange {
  std::vector<WidthBin> bins;     ///< in order of range
  bool has_growth = false;        ///< the span of ranges suffices for sd_per_beam_step
  double sd_m = 0.0;              ///< constant part; the whole without has_growth
  double sd_per_beam_step = 0.0;  ///< as in laser::WidthConfig
};

/// Estimates what a single observation of another trunk scatters: the variance between the trunks'
/// means, and that of observations about their own trunk's mean, which grows with range (least
/// squares over up to six bins of equal size, at least twelve observations each; both parts >= 0).
/// The variance between trunks is that of the predictive t distribution, because few trunks
/// determine it badly. The observations must not contain gross errors (estimate_trunk_model()
/// removes them). Source: Gelman et al. 2013, Bayesian Data Analysis, section 3.2.
WidthByRange width_by_range(std::vector<WidthObservation> observations);

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
