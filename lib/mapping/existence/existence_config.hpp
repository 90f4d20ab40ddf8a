// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// When a landmark is given up because it was not seen where it should have been. Section
/// `mapper.existence`.
struct ExistenceConfig {
  bool enabled = true;
  double period_s = 0.25;      ///< observations closer in time are one
  double scan_wait_s = 1.0;    ///< of message time: DETECTIONS wait for their SCAN; 0 = not used
  double sure_range_m = 4.0;   ///< within which what nothing hides is seen mostly
  double seen_rate = 0.5;      ///< of the looks at what stands in plain view, those that see it
  double stray_rate = 0.02;    ///< of the looks at an empty place, those that see something
  double log_odds_max = 10.0;  ///< whatever was seen how often, it can go away
};

template <class Visitor>
void describe(Visitor& v, ExistenceConfig& c) {
  v.flag("enabled", c.enabled,
         "drop landmarks that later observations of their position do not show");
  v.expert().number("period_s", c.period_s, 0.0, 60.0, "s",
                    "message time between two observations that count");
  v.expert().number(
      "scan_wait_s", c.scan_wait_s, 0.0, 60.0, "s",
      "message time that DETECTIONS wait for their SCAN, whose beams tell what is gone; 0 = "
      "do without SCAN");
  v.expert().number("sure_range_m", c.sure_range_m, 0.1, 200.0, "m",
                    "without SCAN: from the laser; within it what nothing hides is seen mostly");
  v.expert().number(
      "seen_rate", c.seen_rate, 0.01, 0.99, "1",
      "without SCAN: fraction of observations of a standing thing in plain view that see it");
  v.expert().number("stray_rate", c.stray_rate, 0.0001, 0.5, "1",
                    "without SCAN: fraction of observations of an empty place that see something");
  v.expert().number("log_odds_max", c.log_odds_max, 0.5, 50.0, "1",
                    "without SCAN: most log odds that observations give a landmark: the less, the "
                    "sooner it is dropped");
  v.check(c.stray_rate < c.seen_rate, "stray_rate", "must be below seen_rate");
}

}  // namespace orchard::mapping
