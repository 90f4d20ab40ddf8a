// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace orchard::pose {

/// Pose of base in map at one time, T_map_base, with its covariance.
struct PoseEstimate {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;                ///< in (-pi, pi]
  double pitch_rad = 0.0;              ///< 0 when unknown
  double roll_rad = 0.0;               ///< 0 when unknown
  std::array<double, 6> covariance{};  ///< of (x, y, yaw): xx xy xyaw yy yyaw yawyaw
};

/// The corrected past trajectory: T_map_base at key times, in ascending order of utime. Each
/// revision replaces the previous one completely. Between two key times a consumer interpolates the
/// correction relative to the published POSE, not the poses themselves; where POSE leapt, both
/// sides are key times. A trajectory corrects POSE before `utime`; later ones were published with
/// the correction included.
struct Trajectory {
  std::int64_t utime = 0;           ///< of the newest measurement used
  std::int32_t revision = 1;        ///< +1 per correction
  std::vector<PoseEstimate> poses;  ///< seq, pitch and roll unused
};

/// A part of a trajectory that fits into one message.
struct TrajectoryPage {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int32_t revision = 1;
  std::int32_t page = 0;  ///< 0 ... num_pages - 1
  std::int32_t num_pages = 1;
  std::vector<PoseEstimate> poses;
};

/// Max number of poses per page; derived: 40 kB, within one UDP datagram.
inline constexpr std::size_t kPosesPerPage = 500;

/// Splits a trajectory into pages, in order; their seq is not set. An empty trajectory gives one
/// empty page.
std::vector<TrajectoryPage> paginate(const Trajectory& trajectory,
                                     std::size_t poses_per_page = kPosesPerPage);

/// Reassembles trajectories from pages that arrive in order. A revision with a missing page is
/// dropped when the next one begins.
class TrajectoryCollector {
 public:
  /// Adds a page; returns the trajectory when this page completes it.
  std::optional<Trajectory> add(const TrajectoryPage& page);

  std::int64_t num_incomplete() const { return num_incomplete_; }

 private:
  Trajectory partial_;
  std::int32_t next_page_ = 0;  ///< 0: no trajectory in progress
  std::int64_t num_incomplete_ = 0;
};

}  // namespace orchard::pose
