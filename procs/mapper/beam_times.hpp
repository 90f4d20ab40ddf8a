// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "geometry/pose2.hpp"
#include "laser/scan.hpp"

namespace orchard::procs {

/// Scans that do not say when each of their beams was sent (beam_period_us), of a robot that moves
/// meanwhile: what they show is misplaced by as much as it moved. Changes no output.
class BeamTimes {
 public:
  /// `range_sd_m`: less than its noise does not matter. Scans farther apart than `gap_max_s` are
  /// those of a robot that is measured at stops.
  BeamTimes(double range_sd_m, double gap_max_s) : range_sd_m_(range_sd_m), gap_max_s_(gap_max_s) {}

  void note_scan(const laser::Scan& scan);
  /// Where base was at a scan that was mapped.
  void note_pose(std::int64_t utime, const geometry::Pose2& T_map_base);

  /// What it comes to, in words for a person; empty for nothing.
  std::string text() const;

  template <class Archive>
  void persist(Archive& archive) {
    archive(turn_fraction_, reach_m_, utime_, x_m_, y_m_, yaw_rad_, num_scans_, num_moved_,
            sum_moved_m_);
  }

 private:
  double range_sd_m_;
  double gap_max_s_;
  double turn_fraction_ =
      0.0;                  ///< of a turn that a scan without beam times covers; 0 = it has them
  double reach_m_ = 0.0;    ///< median range of that scan
  std::int64_t utime_ = 0;  ///< and pose of the last scan; 0 = none
  double x_m_ = 0.0;
  double y_m_ = 0.0;
  double yaw_rad_ = 0.0;
  std::int64_t num_scans_ = 0;
  std::int64_t num_moved_ = 0;  ///< during which base moved by more than the noise of a range
  double sum_moved_m_ = 0.0;    ///< in those, at the median range
};

}  // namespace orchard::procs
