// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/pose2.hpp"
#include "io/map/map_folder.hpp"
#include "laser/scan.hpp"

namespace orchard::procs {

/// Intervals of a drive in which an expected input was missing while the mapper continued without
/// it, and the landmarks first seen in them.
///
/// Depends on message times only, not on the order in which the channels arrive.
class Degradation {
 public:
  /// `has_camera`: DETECTIONS without a picture count as degraded.
  explicit Degradation(bool has_camera) : has_camera_(has_camera) {}

  /// Adds a mapped scan; `image_utime` 0: without a picture. `last_id`: the highest landmark id so
  /// far.
  void note_scan(std::int64_t utime, std::int64_t image_utime, std::int32_t last_id);
  /// Adds a usable GNSS fix.
  void note_fix(std::int64_t utime);

  /// All intervals so far, in order of time; none for GNSS if the rig never had a fix.
  std::vector<io::DegradedInterval> intervals() const;

  /// True if the last scan is in an interval without pictures.
  bool lacks_pictures_now() const { return has_camera_ && !pictures_.empty() && is_open_; }

  /// The finding as text for the user; empty if there is none.
  std::string text() const;

 private:
  using Span = std::pair<std::int64_t, std::int64_t>;
  std::int32_t id_at(std::int64_t utime) const;
  bool has_scan_between(std::int64_t after_utime, std::int64_t before_utime) const;

  bool has_camera_;
  std::optional<std::int64_t> first_utime_;
  std::int64_t last_utime_ = 0;
  std::optional<std::int64_t> last_picture_utime_;  ///< of the last scan with a picture
  bool is_open_ = false;                            ///< the last of pictures_ has not ended
  std::vector<Span> pictures_;                      ///< intervals without pictures
  std::optional<std::int64_t> first_fix_utime_, last_fix_utime_;
  std::vector<Span> fixes_;                                 ///< intervals between two fixes
  std::vector<std::pair<std::int64_t, std::int32_t>> ids_;  ///< highest id by time, once a second
};

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
