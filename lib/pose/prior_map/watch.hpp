// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

namespace orchard::pose {

/// A landmark that a scan should have shown.
struct ExpectedLandmark {
  std::int32_t landmark = 0;
  bool seen = false;
};

/// Which trees of the last scans were there: by trees, not by sightings, so that one tree that was
/// felled counts once however long the robot stands before its stump.
class TreeWatch {
 public:
  struct Count {
    int num_trees = 0;  ///< that several of the scans should have shown
    int num_there = 0;  ///< of these, that most of those scans did
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
