// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapping/bulk_centre.hpp"
#include "mapping/observation.hpp"
#include "mapping/pose_composition.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Every observation that became part of a landmark, chained per landmark from the newest to the
/// oldest, and where base was in each scan.
class ObservationStore {
 public:
  /// Starts the next scan.
  void add_scan(const pose::PoseEstimate& T_map_base) { scans_.emplace_back(T_map_base); }

  /// Index of the scan that was started last.
  std::int32_t last_scan() const { return static_cast<std::int32_t>(scans_.size()) - 1; }
  const PoseComposition& last_composition() const { return scans_.back(); }

  /// Puts an observation of the last scan before the chain that starts at `head`; the new head.
  std::int32_t prepend(Observation observation, std::int32_t head);

  /// Makes one chain of two, `newer` first; its head.
  std::int32_t join(std::int32_t newer, std::int32_t older);

  /// The first of a chain, `most` at most, composed with the poses as given.
  std::vector<WeightedPoint> newest(std::int32_t head, std::size_t most) const;

 private:
  std::vector<PoseComposition> scans_;
  std::vector<Observation> observations_;
};

}  // namespace orchard::mapping
