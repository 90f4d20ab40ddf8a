// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapping/bulk_centre.hpp"

namespace orchard::mapping {

/// Where landmarks were found to lie last, so that one that is seen and told at every scan is not
/// worked out anew from hundreds of observations each time. By index; holds nothing of landmarks
/// with few observations, which are worked out every time.
class CentreCache {
 public:
  /// The centre of a landmark with so many observations: as known, or from make() when a sixteenth
  /// of them, or more than kFew, have come since.
  template <class Make>
  const BulkCentre& at(std::int32_t index, std::int32_t num_observations, Make&& make) {
    if (num_observations <= kFew) return few_ = make();
    const auto i = static_cast<std::size_t>(index);
    if (i >= known_.size()) known_.resize(i + 1 + known_.size() / 4);
    Known& known = known_[i];
    const std::int32_t num_new = num_observations - known.num_observations;
    if (num_new >= kFew || 16 * num_new >= num_observations) {
      known = {make(), num_observations};
    }
    return known.centre;
  }

  /// To be worked out anew the next time.
  void forget(std::int32_t index) {
    if (static_cast<std::size_t>(index) < known_.size()) known_[index].num_observations = 0;
  }

  std::size_t num_bytes() const { return known_.capacity() * sizeof(Known); }

 private:
  static constexpr std::int32_t kFew = 32;
  struct Known {
    BulkCentre centre;
    std::int32_t num_observations = 0;
  };
  std::vector<Known> known_;
  BulkCentre few_;
};

}  // namespace orchard::mapping
