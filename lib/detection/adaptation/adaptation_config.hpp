// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::detection {

/// Adaptation of the models of width, colour and brightness while driving. Section
/// `detector.adaptation`. Times are message time.
struct AdaptationConfig {
  bool enabled = false;
  double period_s = 1.0;            ///< time between two steps
  int min_trees = 4;                ///< min number of trees; with fewer a model freezes
  double smoothing_s = 5.0;         ///< time constant of a model's exponential approach
  double width_rate_per_s = 0.002;  ///< max rate, as a fraction of the calibrated width
  double width_limit = 0.15;        ///< max change, as a fraction of the calibrated width
  double colour_rate_per_s = 0.01;
  double colour_limit = 0.4;
  double brightness_rate_per_s = 0.03;
  double brightness_limit = 1.0;
  /// Colour of a trunk in the light of the calibration; 0 = use the first trees of a drive.
  double reference_blue = 0.0;   ///< blue over green
  double reference_red = 0.0;    ///< red over green
  double reference_green = 0.0;  ///< grey levels
};

template <class Visitor>
void describe(Visitor& v, AdaptationConfig& c) {
  v.flag("enabled", c.enabled,
         "adapt the models of trunk width, colour and brightness to the trees while driving");
  v.expert().number("period_s", c.period_s, 0.05, 600, "s",
                    "interval between two adaptation steps (message time)");
  v.expert().integer("min_trees", c.min_trees, 2, 12, "trees",
                     "min number of recent trees; with fewer a model is not adapted");
  v.expert().number("smoothing_s", c.smoothing_s, 0.05, 3600, "s",
                    "time constant of the adaptation; larger is slower and smoother");
  v.expert().number("width_rate_per_s", c.width_rate_per_s, 0, 1, "1/s",
                    "max rate of change of the width, as a fraction of the calibrated width");
  v.expert().number("width_limit", c.width_limit, 0, 1, "1",
                    "max change of the width, as a fraction of the calibrated width");
  v.expert().number("colour_rate_per_s", c.colour_rate_per_s, 0, 10, "1/s",
                    "max rate of change of a colour (log of the ratio of red or blue to green)");
  v.expert().number("colour_limit", c.colour_limit, 0, 3, "1",
                    "max change of a colour (log of that ratio)");
  v.expert().number("brightness_rate_per_s", c.brightness_rate_per_s, 0, 10, "1/s",
                    "max rate of change of the brightness (log)");
  v.expert().number("brightness_limit", c.brightness_limit, 0, 5, "1",
                    "max change of the brightness (log)");
  v.expert().number("reference_blue", c.reference_blue, 0, 20, "1",
                    "ratio of blue to green of a trunk, from `orchard calibrate trunks`; 0 = from "
                    "the first trees of a drive");
  v.expert().number("reference_red", c.reference_red, 0, 20, "1",
                    "ratio of red to green of a trunk, from `orchard calibrate trunks`; 0 = from "
                    "the first trees of a drive");
  v.expert().number("reference_green", c.reference_green, 0, 255, "grey",
                    "green level of a trunk, from `orchard calibrate trunks`; 0 = from the first "
                    "trees of a drive");
  v.check((c.reference_blue > 0) == (c.reference_red > 0) &&
              (c.reference_blue > 0) == (c.reference_green > 0),
          "reference_blue", "the three references must be given together or not at all");
}

}  // namespace orchard::detection
