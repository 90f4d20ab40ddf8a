// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::calibration {

/// One measured trunk width.
struct WidthObservation {
  double range_m = 0.0;
  double beam_step_rad = 0.0;
  double width_m = 0.0;
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
  double sd_m = 0.0;              ///< constant part; sd of all observations without has_growth
  double sd_per_beam_step = 0.0;  ///< as in laser::WidthConfig
};

/// Divides the observations into up to six bins of equal size, at least twelve each, and fits the
/// scatter to the bins' variances: least squares weighted by the number of observations, both parts
/// >= 0. The observations must not contain gross errors (estimate_trunk_model() removes them).
WidthByRange width_by_range(std::vector<WidthObservation> observations);

}  // namespace orchard::calibration
