// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "geometry/pose2.hpp"
#include "laser/scan.hpp"

namespace orchard::procs {

/// Detects scans without beam times (beam_period_us) from a moving robot: their points are
/// misplaced by the motion during the sweep. Changes no output.
class BeamTimes {
 public:
  /// `range_sd_m`: smaller motions are ignored. Scans farther apart than `gap_max_s` [s] are taken
  /// as stops of the robot.
  BeamTimes(double range_sd_m, double gap_max_s) : range_sd_m_(range_sd_m), gap_max_s_(gap_max_s) {}

  void note_scan(const laser::Scan& scan);
  /// Adds the pose of base at a mapped scan.
  void note_pose(std::int64_t utime, const geometry::Pose2& T_map_base);

  /// The finding as text for the user; empty if there is none.
  std::string text() const;

 private:
  double range_sd_m_;
  double gap_max_s_;
  double turn_fraction_ =
      0.0;  ///< fraction of a turn covered by a scan without beam times; 0: it has beam times
  double reach_m_ = 0.0;    ///< median range of that scan
  std::int64_t utime_ = 0;  ///< time of the last pose; 0: none
  double x_m_ = 0.0;
  double y_m_ = 0.0;
  double yaw_rad_ = 0.0;
  std::int64_t num_scans_ = 0;
  std::int64_t num_moved_ = 0;  ///< scans with a motion above range_sd_m_
  double sum_moved_m_ = 0.0;    ///< sum of these motions, at the median range
};

}  // namespace orchard::procs
