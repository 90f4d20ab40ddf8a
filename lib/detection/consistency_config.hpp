// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::detection {

/// When laser and image edges disagree so much and so long that a person must hear of it. Section
/// `detector.consistency`.
struct ConsistencyConfig {
  bool enabled = true;
  double look_period_s = 0.5;  ///< of message time: between two looks at a picture's edges
  double reach_deg = 4.0;      ///< the largest disagreement that is looked for
  double window_s = 20.0;      ///< of message time: what the running median is of
  int min_looks = 20;          ///< at objects, in the window
  double warn_deg = 0.75;      ///< a median from this on raises the warning
  double clear_deg = 0.5;      ///< one below this takes it back
};

template <class Visitor>
void describe(Visitor& v, ConsistencyConfig& c) {
  v.flag("enabled", c.enabled, "compare laser and image edges and warn when they disagree");
  v.number("look_period_s", c.look_period_s, 0, 60, "s", "message time between two looks");
  v.number("reach_deg", c.reach_deg, 0.5, 15, "deg", "the largest disagreement looked for");
  v.number("window_s", c.window_s, 1, 600, "s", "message time that the running median is of");
  v.integer("min_looks", c.min_looks, 3, 10000, "1", "at objects in that time; fewer say nothing");
  v.number("warn_deg", c.warn_deg, 0.05, 15, "deg", "a median from this on warns");
  v.number("clear_deg", c.clear_deg, 0, 15, "deg", "a median below this takes the warning back");
  v.check(c.clear_deg <= c.warn_deg, "clear_deg", "must not be above warn_deg");
  v.check(c.warn_deg <= c.reach_deg, "warn_deg", "must not be above reach_deg");
}

}  // namespace orchard::detection
