// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::laser {

/// roc_laser (eq. 10) at three standard deviations: exp(-4.5).
inline constexpr double kThreeSigmaRoc = 0.011108996538242306;

enum class WidthMode {
  kCompensated,  ///< unbiased: adds the beam step that the chord loses on average
  kPaper,        ///< the chord of Shalal et al. 2013, eq. 8 (with its root)
};

/// Model of trunk widths. Section `detector.width`; calibrated from twenty trees.
struct WidthConfig {
  WidthMode mode = WidthMode::kCompensated;
  double mean_m = 0.090;
  double sd_m = 0.010;
  static constexpr double kSdFloor_m = 0.006;  ///< lower limit of sigma
  double sd_per_beam_step = 0.4;
};

template <class Visitor>
void describe(Visitor& v, WidthConfig& c) {
  v.expert().choice(
      "mode", c.mode, {"compensated", "paper"},
      "width from the beams of an object: unbiased, or the chord of the paper (eq. 8)");
  v.number("mean_m", c.mean_m, 0.005, 5, "m",
           "mean trunk width at the height of the scanner (mu of eq. 9); from `orchard calibrate "
           "trunks` or a calliper");
  v.number("sd_m", c.sd_m, 0, 2, "m",
           "standard deviation of trunk widths (sigma of eq. 9); from `orchard calibrate trunks`");
  v.expert().number("sd_per_beam_step", c.sd_per_beam_step, 0, 5, "1",
                    "growth of the standard deviation with range, in units of range x beam step");
}

}  // namespace orchard::laser
