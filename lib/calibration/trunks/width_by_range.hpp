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

/// How trunk widths scatter: sd^2 = sd_m^2 + (sd_per_beam_step x range x step)^2.
struct WidthByRange {
  std::vector<WidthBin> bins;     ///< in order of range
  bool has_growth = false;        ///< the ranges differed enough to tell how sd grows
  double sd_m = 0.0;              ///< at no range; of all observations without has_growth
  double sd_per_beam_step = 0.0;  ///< as laser::WidthConfig has it
};

/// Cuts looks into up to six bins of equally many, twelve at least, and fits the law to the bins'
/// variances: least squares weighted by observations, neither part below 0. Takes observations
/// without gross errors (estimate_trunk_model has left them out).
WidthByRange width_by_range(std::vector<WidthObservation> observations);

}  // namespace orchard::calibration
