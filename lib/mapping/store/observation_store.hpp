// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "mapping/existence/free_space.hpp"
#include "mapping/observation.hpp"
#include "mapping/pose_composition.hpp"
#include "mapping/position_mode.hpp"
#include "mapping/store/cold_array.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Every observation, those of a landmark chained from the newest to the oldest, and of each scan
/// where base was and the free-space evidence of its beams.
class ObservationStore {
 public:
  explicit ObservationStore(std::shared_ptr<ChunkMemory> memory = std::make_shared<HeapMemory>())
      : memory_(memory), scans_(memory), observations_(memory), beams_(memory) {}

  const std::shared_ptr<ChunkMemory>& memory() const { return memory_; }
  /// Nothing of it is needed for the moment.
  void rest() const { memory_->rest(); }

  /// Starts the next scan; `free_space` may be none.
  void add_scan(const pose::PoseEstimate& T_map_base, const FreeSpace* free_space);

  /// Index of the scan that was started last.
  std::int32_t last_scan() const { return static_cast<std::int32_t>(scans_.size()) - 1; }
  const PoseComposition& last_composition() const { return scans_.back().composition; }

  std::int32_t num_scans() const { return static_cast<std::int32_t>(scans_.size()); }
  std::int32_t num_observations() const { return static_cast<std::int32_t>(observations_.size()); }

  /// T_map_base of a scan as it was given.
  const pose::PoseEstimate& pose(std::int32_t scan) const { return at(scan).T_map_base; }

  /// None where none was given.
  std::shared_ptr<const FreeSpace> free_space(std::int32_t scan) const;

  /// Observations of a scan: those from first_of(scan) up to first_of(scan + 1), not included.
  std::int32_t first_of(std::int32_t scan) const {
    return scan < num_scans() ? at(scan).first : num_observations();
  }
  const Observation& operator[](std::int32_t observation) const {
    return observations_[static_cast<std::size_t>(observation)];
  }

  /// Puts an observation of the last scan before the chain that starts at `head`; the new head.
  std::int32_t prepend(Observation observation, std::int32_t head);

  /// Stores an observation of the last scan that is in no chain: after a correction it may be.
  void add_unassociated(Observation observation);

  /// Makes one chain of two, `newer` first; its head.
  std::int32_t join(std::int32_t newer, std::int32_t older);

  /// Makes these observations one chain, whatever chains they were in; its head, -1 for none.
  std::int32_t relink(std::vector<std::int32_t> observations);

  /// The observations of a chain, the newest first, `most` at most.
  std::vector<std::int32_t> newest_of(std::int32_t head, std::size_t most) const;

  /// Where an observation lies in map by the pose of its scan.
  Eigen::Vector2d p_map(std::int32_t observation) const;

  void persist(StateArchive& archive) { archive(scans_, observations_, beams_); }

  /// The first of a chain, `most` at most, composed with the poses as given.
  std::vector<WeightedPoint> newest(std::int32_t head, std::size_t most) const;

 private:
  struct Scan {
    pose::PoseEstimate T_map_base;
    PoseComposition composition;
    std::int32_t first = 0;        ///< of its observations
    std::int64_t free_space = -1;  ///< index of its first byte in beams_, or -1
  };
  const Scan& at(std::int32_t scan) const { return scans_[static_cast<std::size_t>(scan)]; }

  std::shared_ptr<ChunkMemory> memory_;
  ColdArray<Scan> scans_;
  ColdArray<Observation> observations_;
  ColdArray<std::uint8_t> beams_;  ///< free space, packed
};

}  // namespace orchard::mapping
