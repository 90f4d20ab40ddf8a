// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// How detections become landmarks. Section `mapper`.
struct MapperConfig {
  double gate_m = 0.30;            ///< farthest a detection may lie from its landmark
  double pose_wait_s = 10.0;       ///< of message time: how long DETECTIONS wait for a POSE
  double pose_gap_max_s = 2.0;     ///< poses farther apart are not interpolated between
  int min_observations = 1;        ///< landmarks seen less often are left out of map files
  double refresh_period_s = 2.0;   ///< of message time: between two slow refreshes of MAP
  double save_period_s = 1.0;      ///< of wall time: between two saves while live
};

template <class Visitor>
void describe(Visitor& v, MapperConfig& c) {
  v.number("gate_m", c.gate_m, 0.01, 0.99, "m", "farthest a detection lies from its landmark");
  v.number("pose_wait_s", c.pose_wait_s, 0, 3600, "s", "message time that detections wait for a pose");
  v.number("pose_gap_max_s", c.pose_gap_max_s, 0.001, 3600, "s",
           "poses farther apart are not interpolated between");
  v.integer("min_observations", c.min_observations, 1, 1000, "1",
            "landmarks seen less often stay out of map files");
  v.number("refresh_period_s", c.refresh_period_s, 0.05, 3600, "s",
           "message time between two refreshes of the whole map");
  v.number("save_period_s", c.save_period_s, 0.1, 3600, "s", "wall time between two live saves");
}

}  // namespace orchard::mapping
