// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "mapping/existence/existence_config.hpp"
#include "mapping/existence/free_space.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/map_update.hpp"
#include "mapping/store/state_archive.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Optional stage: a filter of each landmark's existence probability. People walk on, vehicles
/// drive away.
///
/// An observation is evidence for a landmark, and so is any return of a beam from its position,
/// whatever the detector made of it. Beams that pass through a landmark, across it and across all
/// where it may be, are evidence against it. Landmarks that are hidden or out of reach keep their
/// odds. A scan that misses more of what is well known than it finds says nothing: its pose is
/// wrong. The log odds are bounded, so that what stood for long can go, too. The cost depends on
/// what stands in view, not on the size of the map.
class ExistenceFilter {
 public:
  /// `p_base_laser`: where the laser sits in base.
  ExistenceFilter(const ExistenceConfig& config, const Eigen::Vector2d& p_base_laser)
      : config_(config), p_base_laser_(p_base_laser) {}

  /// Adds the evidence of the scan that was added to the landmarks last: `update` says which it
  /// observed. Removes landmarks that are gone, and says so in `update`.
  void update(const std::shared_ptr<const FreeSpace>& free_space,
              const pose::PoseEstimate& T_map_base, LandmarkTable& landmarks, MapUpdate& update);

  /// Whether a thing seen for the first time was not there before: the scans of the last while, the
  /// one that shows it among them, saw its place free more often than not. What walks is at every
  /// place for a moment only, also where no later scan looks.
  bool was_free_before(const Eigen::Vector2d& p_map, double width_m, double sd_m) const;

  void persist(StateArchive& archive);

 private:
  struct Evidence;
  Evidence evidence_of(const std::vector<std::int32_t>& changed_ids,
                       const pose::PoseEstimate& T_map_base, const FreeSpace& free_space,
                       const LandmarkTable& landmarks) const;

  /// A scan whose pose was trusted.
  struct Observation {
    pose::PoseEstimate T_map_base;
    std::shared_ptr<const FreeSpace> free_space;
  };

  ExistenceConfig config_;
  Eigen::Vector2d p_base_laser_;
  std::optional<std::int64_t> last_utime_;  ///< of the last scan that counted
  std::deque<Observation> observations_;    ///< the newest ones
};

}  // namespace orchard::mapping
