// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

namespace orchard::pose {

/// A landmark that should be visible in a scan.
struct ExpectedLandmark {
  std::int32_t landmark = 0;
  bool seen = false;
};

/// Counts the expected trees that were observed in the last scans. It counts trees, not
/// observations, so that a felled tree counts once however long the robot stands before its stump.
class TreeDetectionMonitor {
 public:
  struct Count {
    int num_trees = 0;     ///< trees expected in several of the scans
    int num_detected = 0;  ///< of these, trees observed in at least half of those scans
  };

  void add(std::vector<ExpectedLandmark> scan);
  void clear() { scans_.clear(); }
  Count count() const;

 private:
  static constexpr std::size_t kScans = 10;
  static constexpr int kSureScans = 4;

  std::deque<std::vector<ExpectedLandmark>> scans_;
};

}  // namespace orchard::pose
