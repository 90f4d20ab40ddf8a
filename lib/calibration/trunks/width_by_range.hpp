// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace orchard::calibration
