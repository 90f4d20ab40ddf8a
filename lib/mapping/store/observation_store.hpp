// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "detection/detection.hpp"
#include "mapping/candidate.hpp"
#include "mapping/free_space.hpp"
#include "mapping/position_mode.hpp"
#include "mapping/store/chunked_array.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// One stored detection: everything needed to rebuild the landmarks after a pose correction.
struct Observation {
  std::int32_t scan = 0;       ///< index into the mapper's list of scans
  std::int32_t previous = -1;  ///< previous observation of the same landmark, or -1
  float x_base_m = 0.0f;       ///< centre in base
  float y_base_m = 0.0f;
  float sd_m = 0.0f;  ///< of the centre in map, per axis: detection and pose combined
  float roc_tree = 0.0f;
  float width_m = 0.0f;
  float width_sd_m = 0.0f;
  float covariance_xx = 0.0f;  ///< of the centre in base [m2]
  float covariance_xy = 0.0f;
  float covariance_yy = 0.0f;
  float probability_tree = 0.0f;
  float probability_object = 0.0f;
  std::int8_t label = 0;       ///< detection::Label
  std::int8_t occlusion = 0;   ///< bits of detection::Occlusion
  std::uint8_t num_beams = 0;  ///< 255 means 255 or more
};

/// Converts a candidate to its stored form; scan and previous are not set.
Observation observation_of(const Candidate& candidate);

/// Restores all fields of a stored detection that the map depends on.
detection::Detection detection_of(const Observation& observation);

/// All observations and scans. The observations of a landmark form a chain from newest to oldest;
/// each scan has the pose of base and the free-space evidence of its beams.
class ObservationStore {
 public:
  explicit ObservationStore(
      std::shared_ptr<ChunkAllocator> memory = std::make_shared<HeapChunkAllocator>())
      : memory_(memory), scans_(memory), observations_(memory), beams_(memory) {}

  const std::shared_ptr<ChunkAllocator>& memory() const { return memory_; }

  /// Starts the next scan; `free_space` may be null.
  void add_scan(const pose::PoseEstimate& T_map_base, const FreeSpace* free_space);

  /// Index of the newest scan.
  std::int32_t last_scan() const { return static_cast<std::int32_t>(scans_.size()) - 1; }
  const PoseComposition& last_composition() const { return scans_.back().composition; }

  std::int32_t num_scans() const { return static_cast<std::int32_t>(scans_.size()); }
  std::int32_t num_observations() const { return static_cast<std::int32_t>(observations_.size()); }

  /// T_map_base of a scan as given to add_scan().
  const pose::PoseEstimate& pose(std::int32_t scan) const { return at(scan).T_map_base; }

  /// Free-space evidence of a scan; null if none was given.
  std::shared_ptr<const FreeSpace> free_space(std::int32_t scan) const;
  bool has_free_space(std::int32_t scan) const { return at(scan).free_space >= 0; }

  /// Index of the first observation of a scan; its observations end before first_of(scan + 1).
  std::int32_t first_of(std::int32_t scan) const {
    return scan < num_scans() ? at(scan).first : num_observations();
  }
  const Observation& operator[](std::int32_t observation) const {
    return observations_[static_cast<std::size_t>(observation)];
  }

  /// Adds an observation of the newest scan in front of the chain that starts at `head`; returns
  /// the new head.
  std::int32_t prepend(Observation observation, std::int32_t head);

  /// Adds an observation of the newest scan to no chain; a correction may associate it later.
  void add_unassociated(Observation observation);

  /// Joins two chains, `newer` first; returns the head.
  std::int32_t join(std::int32_t newer, std::int32_t older);

  /// The newest `most` observations of a chain, newest first.
  std::vector<std::int32_t> newest_of(std::int32_t head, std::size_t most) const;

  /// Position of an observation in map, by the pose of its scan.
  Eigen::Vector2d p_map(std::int32_t observation) const;

  /// The newest `most` observations of a chain, composed with the given poses.
  std::vector<WeightedPoint> newest(std::int32_t head, std::size_t most) const;

 private:
  struct Scan {
    pose::PoseEstimate T_map_base;
    PoseComposition composition;
    std::int32_t first = 0;        ///< index of the first observation
    std::int64_t free_space = -1;  ///< index of its first byte in beams_, or -1
  };
  const Scan& at(std::int32_t scan) const { return scans_[static_cast<std::size_t>(scan)]; }

  std::shared_ptr<ChunkAllocator> memory_;
  ChunkedArray<Scan> scans_;
  ChunkedArray<Observation> observations_;
  ChunkedArray<std::uint8_t> beams_;  ///< packed free-space evidence
};

}  // namespace orchard::mapping
