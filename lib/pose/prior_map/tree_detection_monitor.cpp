// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/tree_detection_monitor.hpp"

#include <algorithm>
#include <utility>

namespace orchard::pose {

void TreeDetectionMonitor::add(std::vector<ExpectedLandmark> scan) {
  scans_.push_back(std::move(scan));
  if (scans_.size() > kScans) scans_.pop_front();
}

TreeDetectionMonitor::Count TreeDetectionMonitor::count() const {
  std::vector<ExpectedLandmark> all;
  for (const auto& scan : scans_) all.insert(all.end(), scan.begin(), scan.end());
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.landmark < b.landmark; });
  Count count;
  for (auto begin = all.begin(), end = begin; begin != all.end(); begin = end) {
    while (end != all.end() && end->landmark == begin->landmark) ++end;
    if (end - begin < kSureScans) continue;
    ++count.num_trees;
    const auto seen = std::count_if(begin, end, [](const auto& e) { return e.seen; });
    count.num_detected += 2 * seen >= end - begin;
  }
  return count;
}

}  // namespace orchard::pose
