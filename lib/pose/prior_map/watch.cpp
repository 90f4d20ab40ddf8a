// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/watch.hpp"

#include <algorithm>
#include <utility>

namespace orchard::pose {

void TreeWatch::add(std::vector<ExpectedLandmark> scan) {
  scans_.push_back(std::move(scan));
  if (scans_.size() > kScans) scans_.pop_front();
}

TreeWatch::Count TreeWatch::count() const {
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
    count.num_there += 2 * seen >= end - begin;
  }
  return count;
}

}  // namespace orchard::pose
