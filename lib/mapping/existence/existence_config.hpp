// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

/// Configuration of the existence filter, section `mapper.existence`.
struct ExistenceConfig {
  bool enabled = true;
  double period_s = 0.25;    ///< min time between two scans that are used
  double scan_wait_s = 1.0;  ///< message time that DETECTIONS wait for their SCAN; 0 = not used
};

template <class Visitor>
void describe(Visitor& v, ExistenceConfig& c) {
  v.flag("enabled", c.enabled,
         "remove landmarks when beams of later scans pass through their position; needs SCAN");
  v.expert().number("period_s", c.period_s, 0.0, 60.0, "s",
                    "min time between two scans that are used (message time)");
  v.expert().number("scan_wait_s", c.scan_wait_s, 0.0, 60.0, "s",
                    "max time that DETECTIONS wait for their SCAN (message time); 0 = do not use "
                    "SCAN, no landmark is removed");
}

}  // namespace orchard::mapping
