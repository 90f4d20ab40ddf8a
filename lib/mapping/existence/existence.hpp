// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/candidate.hpp"
#include "mapping/existence/existence_config.hpp"
#include "mapping/existence/free_space.hpp"
#include "mapping/landmark_table.hpp"
#include "pose/sight_field.hpp"

namespace orchard::mapping {

/// Weighs whether what was once seen still stands there: people walk on, vehicles drive away.
///
/// An observation is evidence for a thing, and so is any return of a beam from its place, whatever
/// the detector made of it. A look whose beams see past a thing, across it and across all where it
/// may be, is evidence against it.
///
/// Without beams each look at its place in plain view (where the scanner sees for sure, nothing
/// nearer in the way, nothing else seen there) that does not detect it is evidence against it. From
/// sides on which it has never been seen such a look says little: grass may hide it there.
///
/// A scan that misses more of what is well known than it sees says nothing: its pose is wrong. The
/// evidence is bounded, so that what stood for long can go, too. Costs what stands in view,
/// whatever the size of the map.
class PresenceWatch {
 public:
  /// `p_base_laser`: where the laser sits in base.
  PresenceWatch(const ExistenceConfig& config, const Eigen::Vector2d& p_base_laser)
      : config_(config), p_base_laser_(p_base_laser), sight_(config.sure_range_m) {}

  /// Takes the scan that the landmarks took last, which observed `observed` (indices), and its
  /// beams, if known. Indices of the landmarks that are no more, in rising order: the caller's to
  /// remove.
  std::vector<std::int32_t> review(const std::vector<Candidate>& candidates,
                                   const std::vector<std::int32_t>& observed,
                                   const pose::PoseEstimate& T_map_base, const BeamLook* look,
                                   LandmarkTable& landmarks);

 private:
  struct Verdicts;
  void acknowledge(const std::vector<std::int32_t>& observed, const Eigen::Vector2d& laser_map,
                   LandmarkTable& landmarks) const;
  Verdicts of_beams(const std::vector<std::int32_t>& observed, const pose::PoseEstimate& T_map_base,
                    const BeamLook& look, const LandmarkTable& landmarks) const;
  Verdicts of_detections(const std::vector<Candidate>& candidates,
                         const std::vector<std::int32_t>& observed,
                         const pose::PoseEstimate& T_map_base, const LandmarkTable& landmarks);

  ExistenceConfig config_;
  Eigen::Vector2d p_base_laser_;
  pose::SightField sight_;                  ///< from the laser, axes of base
  bool by_beams_ = false;                   ///< whether the last look that counted was one of beams
  std::optional<std::int64_t> last_utime_;  ///< of the last scan whose misses counted
};

}  // namespace orchard::mapping
