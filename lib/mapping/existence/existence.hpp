// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "mapping/existence/ground_occupancy.hpp"
#include "mapping/free_space.hpp"
#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"
#include "mapping/mapper_config.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Log odds of existence from a returned beam or an observation.
double log_odds_of_return();

/// Weighting of a pass-through by few beams.
enum class BeamWeight {
  kByNumber,  ///< reduced: for consecutive scans, whose pose errors are correlated
  kFull,      ///< full: for scans from all sides
};

/// Log odds of existence from the free-space evidence of one scan.
double log_odds_of(const FreeSpaceAnswer& answer, BeamWeight weight = BeamWeight::kByNumber);

/// Weight of a landmark with `num_observations` observations in validating a scan's pose: a scan
/// that misses more weight than it finds has a wrong pose and is no evidence.
int pose_weight(int num_observations);

/// Optional stage: filters the existence probability of each landmark, because people and vehicles
/// leave.
///
/// Evidence for a landmark: an observation, or any beam returned from its position, whether
/// detected or not. Evidence against: beams that pass through it, both across its width and across
/// its position uncertainty. Occluded landmarks and those out of range keep their log odds. A scan
/// that misses more well-known landmarks than it finds is ignored, because its pose must be wrong.
/// The log odds are bounded, so that landmarks of long standing can be dropped too. The cost
/// depends on the number of landmarks in view, not on the size of the map.
class ExistenceFilter {
 public:
  /// `p_base_laser`: position of the laser in base.
  ExistenceFilter(const ExistenceConfig& config, const Eigen::Vector2d& p_base_laser)
      : config_(config), p_base_laser_(p_base_laser) {}

  /// Adds the evidence of the newest scan, whose observed landmarks are in `update`. Removes
  /// landmarks that are gone and lists them in `update`.
  void update(const std::shared_ptr<const FreeSpace>& free_space,
              const pose::PoseEstimate& T_map_base, LandmarkTable& landmarks, MapUpdate& update);

  /// Whether a newly detected object was absent before: recent scans, including the current one,
  /// found its position free more often than not. A moving object occupies each position only
  /// briefly, even where no later scan looks.
  bool was_free_before(const Eigen::Vector2d& p_map, double width_m, double sd_m) const;

 private:
  struct Evidence;
  Evidence evidence_of(const std::vector<std::int32_t>& changed_ids,
                       const pose::PoseEstimate& T_map_base, const FreeSpace& free_space,
                       const LandmarkTable& landmarks) const;

  /// A scan with a validated pose.
  struct Observation {
    pose::PoseEstimate T_map_base;
    std::shared_ptr<const FreeSpace> free_space;
  };

  ExistenceConfig config_;
  Eigen::Vector2d p_base_laser_;
  std::optional<std::int64_t> last_utime_;  ///< of the last scan used
  std::deque<Observation> observations_;    ///< newest scans used, oldest first
};

/// Indices of landmarks that most likely never existed or did not stay, in ascending order: those
/// with few observations while most scans with a view of their position passed through it, or saw
/// most of their ground free; and foliage of a bush.
///
/// Run when the map is written, with the same rates as the ExistenceFilter, which only weighs scans
/// after a landmark's first observation. Landmarks with many observations are left to that filter.
std::vector<std::int32_t> spurious_landmarks(const MapState& map, GroundOccupancy& ground);

}  // namespace orchard::mapping
