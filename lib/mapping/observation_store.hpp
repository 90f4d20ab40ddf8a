// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "mapping/beam_look.hpp"
#include "mapping/bulk_centre.hpp"
#include "mapping/observation.hpp"
#include "mapping/pose_composition.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Every observation that became part of a landmark, chained per landmark from the newest to the
/// oldest, and of each scan where base was and what its beams looked at.
class ObservationStore {
 public:
  /// Starts the next scan; `look` may be none.
  void add_scan(const pose::PoseEstimate& T_map_base, std::shared_ptr<const BeamLook> look) {
    scans_.push_back(
        {T_map_base, PoseComposition(T_map_base), num_observations(), std::move(look)});
  }

  /// Index of the scan that was started last.
  std::int32_t last_scan() const { return static_cast<std::int32_t>(scans_.size()) - 1; }
  const PoseComposition& last_composition() const { return scans_.back().composition; }

  std::int32_t num_scans() const { return static_cast<std::int32_t>(scans_.size()); }
  std::int32_t num_observations() const { return static_cast<std::int32_t>(observations_.size()); }

  /// T_map_base of a scan as it was given.
  const pose::PoseEstimate& pose(std::int32_t scan) const { return at(scan).T_map_base; }

  const std::shared_ptr<const BeamLook>& look(std::int32_t scan) const { return at(scan).look; }

  /// Observations of a scan: those from first_of(scan) up to first_of(scan + 1), not included.
  std::int32_t first_of(std::int32_t scan) const {
    return scan < num_scans() ? at(scan).first : num_observations();
  }
  const Observation& operator[](std::int32_t observation) const {
    return observations_[static_cast<std::size_t>(observation)];
  }

  /// Puts an observation of the last scan before the chain that starts at `head`; the new head.
  std::int32_t prepend(Observation observation, std::int32_t head);

  /// Makes one chain of two, `newer` first; its head.
  std::int32_t join(std::int32_t newer, std::int32_t older);

  /// The first of a chain, `most` at most, composed with the poses as given.
  std::vector<WeightedPoint> newest(std::int32_t head, std::size_t most) const;

 private:
  struct Scan {
    pose::PoseEstimate T_map_base;
    PoseComposition composition;
    std::int32_t first = 0;  ///< of its observations
    std::shared_ptr<const BeamLook> look;
  };
  const Scan& at(std::int32_t scan) const { return scans_[static_cast<std::size_t>(scan)]; }

  std::vector<Scan> scans_;
  std::vector<Observation> observations_;
};

}  // namespace orchard::mapping
