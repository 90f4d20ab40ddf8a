// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::detection {

/// Monitor that warns when laser and image edges disagree for long. Section
/// `detector.extrinsics_monitor`.
struct ConsistencyConfig {
  bool enabled = true;
};

template <class Visitor>
void describe(Visitor& v, ConsistencyConfig& c) {
  v.flag("enabled", c.enabled,
         "compare laser and image edges while driving and warn if they disagree for long");
}

}  // namespace orchard::detection
