// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace orchard::pose {

/// Time in which positions of one source were displaced, e.g. by reflected signals.
struct DisplacedTime {
  std::int64_t begin_utime = 0;
  std::int64_t end_utime = 0;  ///< of the last displaced position
  bool is_gnss = true;

  friend bool operator==(const DisplacedTime& a, const DisplacedTime& b) {
    return a.begin_utime == b.begin_utime && a.end_utime == b.end_utime && a.is_gnss == b.is_gnss;
  }
};

/// One account of when positions were displaced.
struct DisplacementHistory {
  double probability = 1.0;
  std::vector<DisplacedTime> displaced;  ///< ascending
};

/// The credible histories that led to one and the same present.
///
/// What comes later cannot tell them apart, so that their probabilities stay as they are.
class DisplacementHistories {
 public:
  /// Returns all, the likeliest first; their probabilities sum to 1.
  const std::vector<DisplacementHistory>& all() const { return all_; }

  const std::vector<DisplacedTime>& likeliest() const { return all_.front().displaced; }

  /// Begins a displaced time in every history.
  void begin(std::int64_t utime, bool is_gnss);

  /// Extends the newest displaced time of every history; each must have one.
  void extend(std::int64_t utime);

  /// Takes in the histories of another account of the same present, with the odds of that against
  /// this.
  void merge(const DisplacementHistories& other, double odds);

 private:
  std::vector<DisplacementHistory> all_{DisplacementHistory{}};
};

}  // namespace orchard::pose
