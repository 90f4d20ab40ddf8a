// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// When a landmark is given up because it was not seen where it should have been. Section
/// `mapper.presence`.
struct PresenceConfig {
  bool enabled = true;
  double period_s = 0.25;       ///< looks closer in time say the same
  double scan_wait_s = 1.0;     ///< of message time: DETECTIONS wait for their SCAN; 0 = not used
  double beam_reach_m = 8.0;    ///< within which beams are asked
  double past_rate = 0.1;       ///< of the looks of beams at a standing thing, those that see past
  double past_rate_gone = 0.7;  ///< of those at an empty place
  int past_beams = 6;           ///< beams across a thing from which on a look past it counts fully
  double past_sigmas = 2.0;     ///< how far about its place a thing may stand
  double past_share = 0.8;      ///< of the beams across where it may stand, those that go on
  double beam_log_odds_max = 8.0;
  double log_odds_gone = -2.0;
};

template <class Visitor>
void describe(Visitor& v, PresenceConfig& c) {
  v.flag("enabled", c.enabled,
         "drop landmarks whose position beams of later scans pass through; needs SCAN");
  v.number("period_s", c.period_s, 0.0, 60.0, "s", "message time between two looks that count");
  v.number("scan_wait_s", c.scan_wait_s, 0.0, 60.0, "s",
           "message time that DETECTIONS wait for their SCAN, whose beams tell what is gone; 0 = "
           "without SCAN, and nothing is dropped");
  v.number("beam_reach_m", c.beam_reach_m, 0.5, 200.0, "m",
           "from the laser; within it beams are asked");
  v.number("past_rate", c.past_rate, 0.001, 0.9, "1",
           "share of looks of beams at a standing thing that see past it");
  v.number("past_rate_gone", c.past_rate_gone, 0.01, 0.99, "1",
           "share of looks of beams at an empty place that see past it");
  v.integer("past_beams", c.past_beams, 2, 100, "1",
            "beams across a thing from which on a look past it counts in full; fewer count by the "
            "square");
  v.number("past_sigmas", c.past_sigmas, 0.0, 10.0, "1",
           "standard deviations of its place (and of ranges) about which a thing may stand");
  v.number("past_share", c.past_share, 0.5, 1.0, "1",
           "share of the beams across where a thing may stand that must go on; across itself all");
  v.number("beam_log_odds_max", c.beam_log_odds_max, 0.5, 50.0, "1",
           "most that looks of beams can say for a thing: the less, the sooner it is given up");
  v.number("log_odds_gone", c.log_odds_gone, -50.0, -0.1, "1", "below this it is dropped");
  v.check(c.past_rate < c.past_rate_gone, "past_rate", "must be below past_rate_gone");
}

}  // namespace orchard::mapping
