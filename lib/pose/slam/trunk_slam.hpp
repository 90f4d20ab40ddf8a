// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "detection/detection.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/slam/dead_reckoning.hpp"
#include "pose/slam/loop_closer.hpp"
#include "pose/slam/slam_map.hpp"
#include "pose/slam/slam_tracker.hpp"
#include "pose/slam_config.hpp"
#include "pose/submap/scan_closer.hpp"
#include "pose/trajectory.hpp"

namespace orchard::pose {

/// T_map_base from relative motion and trunks without identities, with no prior map: graph SLAM
/// with keyframes and landmarks.
///
/// Dead reckoning adds keyframes to the map; the tracker matches every scan to the landmarks around
/// the robot and corrects the last keyframes; the loop closer, growth of the graph and the end of
/// the drive correct all of them. Measurements come in order of time; the result is a pure function
/// of their sequence.
class TrunkSlam {
 public:
  /// `memory` holds what a long drive leaves; none: the heap. It changes no result.
  explicit TrunkSlam(const SlamConfig& config, const ScanMotionConfig& scans = {},
                     const laser::LaserConfig& mount = {},
                     std::shared_ptr<ChunkMemory> memory = nullptr);

  /// Used for odometry that states no covariance.
  void set_default_noise(double speed_sd_fraction, double yaw_rate_sd_radps);

  void add(const Odometry& odometry);
  /// The motion T_before_now from the last measured time to `utime`, where no wheels measure it.
  void add_motion(std::int64_t utime, const Eigen::Vector3d& T_before_now,
                  const Eigen::Matrix3d& covariance);
  /// What the same scan showed besides, made from base's motion per second (x, y, yaw in base)
  /// where it is wanted: the believable returns [m, base].
  using ScanSource = std::function<std::vector<SurfacePoint>(const Eigen::Vector3d& velocity)>;
  void add(const detection::Detections& seen, const ScanSource& scan = {});
  /// An absolute position of base, or of a point on it, in map; T_keyframe_then is filled in here.
  /// Until such positions have georeferenced the map, its origin is the first pose.
  void add_position(std::int64_t utime, AbsolutePosition position);

  /// The end of the drive: the last and best correction.
  void finish();

  std::optional<PoseEstimate> estimate() const;
  std::optional<Trajectory> take_correction();
  std::string warning() const;
  /// Loops asked for, closed and refused; seconds LOST and AMBIGUOUS; the newest position's
  /// standard deviation [mm].
  std::vector<std::pair<std::string, std::int64_t>> account() const;

  const SlamGraph& graph() const { return map_.graph; }
  /// Loop closures that stand, and those that the observations refuted once they were solved.
  int num_closures() const { return closer_.num_closures() + scan_closer_.num_closures(); }
  int num_refuted_closures() const { return closer_.num_refuted() + scan_closer_.num_refuted(); }
  /// Work done so far, in pairs tried and factors solved: the cost of a scan without a clock.
  std::int64_t num_operations() const {
    return tracker_.num_operations() + closer_.num_operations();
  }

 private:
  Eigen::Matrix3d motion_covariance() const;
  bool wants_keyframe(double factor) const;
  Eigen::Vector3d velocity() const { return {motion_.speed_mps(), 0.0, motion_.yaw_rate_radps()}; }
  void add_keyframe();
  void add_blind_keyframe();
  void correct();
  void watch(std::int64_t utime);
  double end_sd_m() const;

  SlamConfig config_;
  DeadReckoning motion_;  ///< since the newest keyframe
  SlamMap map_;
  SlamTracker tracker_;
  LoopCloser closer_;
  ScanCloser scan_closer_;
  std::int32_t revision_ = 0;
  std::int64_t scan_utime_ = 0;  ///< of the last scan
  std::int64_t driven_us_ = 0;   ///< from scan to scan
  std::int64_t lost_us_ = 0;
  std::int64_t ambiguous_us_ = 0;
  bool finished_ = false;
};

}  // namespace orchard::pose
