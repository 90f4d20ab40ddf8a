// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// When a landmark is given up because it was not seen where it should have been. Section
/// `mapper.presence`.
struct PresenceConfig {
  bool enabled = true;
  double period_s = 0.25;      ///< looks closer in time say the same
  double sure_range_m = 4.0;   ///< within which what nothing hides is seen mostly
  double seen_rate = 0.5;      ///< of the looks at what stands in plain view, those that see it
  double stray_rate = 0.02;    ///< of the looks at an empty place, those that see something
  double log_odds_max = 10.0;  ///< whatever was seen how often, it can go away
  double log_odds_gone = -2.0;
};

template <class Visitor>
void describe(Visitor& v, PresenceConfig& c) {
  v.flag("enabled", c.enabled,
         "drop landmarks that later looks at their place, in plain view, do not see");
  v.number("period_s", c.period_s, 0.0, 60.0, "s", "message time between two looks that count");
  v.number("sure_range_m", c.sure_range_m, 0.1, 200.0, "m",
           "from the laser; within it what nothing hides is seen mostly");
  v.number("seen_rate", c.seen_rate, 0.01, 0.99, "1",
           "share of looks at a standing thing in plain view that see it");
  v.number("stray_rate", c.stray_rate, 0.0001, 0.5, "1",
           "share of looks at an empty place that see something");
  v.number("log_odds_max", c.log_odds_max, 0.5, 50.0, "1",
           "most that looks can say for a thing: the less, the sooner it is given up");
  v.number("log_odds_gone", c.log_odds_gone, -50.0, -0.1, "1", "below this it is dropped");
  v.check(c.stray_rate < c.seen_rate, "stray_rate", "must be below seen_rate");
}

}  // namespace orchard::mapping
