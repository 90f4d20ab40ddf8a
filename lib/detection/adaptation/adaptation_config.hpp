// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::detection {

/// How the models of width, colour and brightness follow the trees while driving. Section
/// `detector.adaptation`. Time is that of the messages.
struct AdaptationConfig {
  bool enabled = false;
  double period_s = 1.0;            ///< between looks at what the trees teach
  double window_s = 40.0;           ///< older trees teach nothing
  int window_trees = 12;            ///< nor do more than this many newest ones
  int min_trees = 4;                ///< fewer freeze a model
  double smoothing_s = 5.0;         ///< a model goes this fast to where the trees are, e-fold
  double teach_laser = 0.3;         ///< roc_laser of a tree that teaches colour
  double teach_vision = 0.55;       ///< roc_vision of a tree that teaches width
  double teach_colour = 0.1;        ///< roc_colour, besides, of a tree that teaches colour
  double colour_gate = 0.3;         ///< largest distance of its colour from the current model's
  double width_rate_per_s = 0.002;  ///< of the calibrated width
  double width_limit = 0.15;        ///< of the calibrated width
  double colour_rate_per_s = 0.01;
  double colour_limit = 0.4;
  double brightness_rate_per_s = 0.03;
  double brightness_limit = 1.0;
  double agreement_min = 0.2;      ///< of what the laser takes for trunks, confirmed
  double collapse_fraction = 0.5;  ///< of the last good share: below it, back
  double separation_max = 4.0;     ///< of two groups, in their pooled standard deviation
  /// A trunk's channels in the light of the calibration; 0 = those of the first trees of a drive.
  double reference_blue = 0.0;   ///< blue over green
  double reference_red = 0.0;    ///< red over green
  double reference_green = 0.0;  ///< grey levels
};

template <class Visitor>
void describe(Visitor& v, AdaptationConfig& c) {
  v.flag("enabled", c.enabled, "follow width, colour and brightness of the trees while driving");
  v.number("period_s", c.period_s, 0.05, 600, "s", "message time between two steps");
  v.number("window_s", c.window_s, 1, 3600, "s", "trees seen longer ago teach nothing");
  v.integer("window_trees", c.window_trees, 2, 1000, "trees", "the newest teach, at most these");
  v.integer("min_trees", c.min_trees, 2, 1000, "trees", "fewer freeze a model");
  v.number("smoothing_s", c.smoothing_s, 0.05, 3600, "s",
           "time constant with which a model goes to where its trees are");
  v.number("teach_laser", c.teach_laser, 0, 1, "1", "least roc_laser of what teaches colour");
  v.number("teach_vision", c.teach_vision, 0, 1, "1", "least roc_vision of what teaches width");
  v.number("teach_colour", c.teach_colour, 0, 1, "1", "least roc_colour of what teaches colour");
  v.number("colour_gate", c.colour_gate, 0.01, 5, "1",
           "what teaches colour is this near the current model (log of a channel's ratio)");
  v.number("width_rate_per_s", c.width_rate_per_s, 0, 1, "1/s",
           "fastest change of the width, as a fraction of the calibrated one");
  v.number("width_limit", c.width_limit, 0, 1, "1",
           "largest change of the width, as a fraction of the calibrated one");
  v.number("colour_rate_per_s", c.colour_rate_per_s, 0, 10, "1/s",
           "fastest change of a colour (log of a channel's ratio to green)");
  v.number("colour_limit", c.colour_limit, 0, 3, "1", "largest change of a colour (log)");
  v.number("brightness_rate_per_s", c.brightness_rate_per_s, 0, 10, "1/s",
           "fastest change of the brightness (log)");
  v.number("brightness_limit", c.brightness_limit, 0, 5, "1",
           "largest change of the brightness (log)");
  v.number("agreement_min", c.agreement_min, 0, 1, "1",
           "freeze when the camera confirms less than this share of what the laser takes for "
           "trunks");
  v.number("collapse_fraction", c.collapse_fraction, 0, 1, "1",
           "go back when the confirmed share falls below this fraction of the last good one");
  v.number("separation_max", c.separation_max, 0.5, 100, "sd",
           "freeze when the trees fall into two groups farther apart than this");
  v.number("reference_blue", c.reference_blue, 0, 20, "1",
           "a calibrated trunk's blue over green; 0 = the first trees of a drive");
  v.number("reference_red", c.reference_red, 0, 20, "1",
           "a calibrated trunk's red over green; 0 = the first trees of a drive");
  v.number("reference_green", c.reference_green, 0, 255, "grey",
           "a calibrated trunk's green; 0 = the first trees of a drive");
  v.check(c.min_trees <= c.window_trees, "min_trees", "must not be above window_trees");
  v.check((c.reference_blue > 0) == (c.reference_red > 0) &&
              (c.reference_blue > 0) == (c.reference_green > 0),
          "reference_blue", "the three references are given together or not at all");
}

}  // namespace orchard::detection
