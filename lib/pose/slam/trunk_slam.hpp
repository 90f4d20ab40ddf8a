// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "detection/detection.hpp"
#include "pose/filter/gnss_positions.hpp"
#include "pose/graph/told_path.hpp"
#include "pose/localiser.hpp"
#include "pose/measurements.hpp"
#include "pose/motion.hpp"
#include "pose/pose_config.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/scan_matching/scan_motion.hpp"
#include "pose/slam/loop_closer.hpp"
#include "pose/slam/scan_loop_closer.hpp"
#include "pose/slam/slam_map.hpp"
#include "pose/slam/slam_tracker.hpp"

namespace orchard::pose {

/// Localiser of pose.mode slam: graph SLAM with keyframes and trunk landmarks. Estimates T_map_base
/// from relative motion and observed trunks without identities, without a prior map, and without
/// fixes unless use_fixes or use_gnss of pose.slam is set. The motion between scans comes from the
/// wheels, or from scan matching with `motion: scans`.
///
/// Dead reckoning adds keyframes to the map. The tracker matches every scan to the landmarks around
/// the robot and corrects the last keyframes. All keyframes are corrected at loop closures, when
/// the graph has grown, and at the end of the drive. Measurements must come in order of time; the
/// result is a pure function of their sequence.
class TrunkSlam : public Localiser {
 public:
  /// `memory` stores old observations (null: the heap) and does not affect the results.
  explicit TrunkSlam(const PoseConfig& config, const laser::LaserConfig& mount = {},
                     const laser::BlindSector& blind = {},
                     std::shared_ptr<ChunkAllocator> memory = nullptr);

  void add(const Measurement& measurement) override;
  /// Adds an absolute position in map of base, or of a point on it; sets its utime and
  /// T_keyframe_then. Until such positions have georeferenced the map, its origin is the first
  /// pose. Ignored if not finite or without a valid covariance.
  void add_position(std::int64_t utime, AbsolutePosition position);

  /// Ends the drive and computes the final, best correction.
  void finish() override;

  std::optional<PoseEstimate> estimate() const override;
  std::optional<Trajectory> take_correction() override;
  std::string warning() const override;
  std::vector<Finding> findings() const override;
  /// Returns statistics: loop searches, closures and undone closures; seconds LOST and AMBIGUOUS;
  /// the standard deviation of the newest position [mm].
  std::vector<std::pair<std::string, std::int64_t>> statistics() const override;

  const SlamGraph& graph() const { return map_.graph; }
  /// Number of accepted loop closures, and of those undone because the observations contradicted
  /// them after the solve.
  int num_closures() const {
    return closer_.counts().num_closures + scan_loop_closer_.counts().num_closures;
  }
  int num_refuted_closures() const {
    return closer_.counts().num_refuted + scan_loop_closer_.counts().num_refuted;
  }
  /// Work done so far, in pairs tried and keyframes solved: a measure of cost without a clock.
  std::int64_t num_operations() const {
    return tracker_.num_operations() + closer_.counts().num_operations;
  }

 private:
  void add(const detection::Detections& seen);
  void add(const PoseFix& fix);
  void add(const Gnss& gnss);
  Eigen::Matrix3d motion_covariance() const;
  bool wants_keyframe(double factor) const;
  Eigen::Vector3d velocity() const { return {motion_.speed_mps(), 0.0, motion_.yaw_rate_radps()}; }
  void add_keyframe();
  void add_blind_keyframe();
  void correct();
  void tell();
  void watch(std::int64_t utime);
  double end_sd_m() const;

  PoseConfig pose_config_;
  SlamConfig config_;
  laser::LaserConfig mount_;
  laser::BlindSector blind_;
  GnssPositions gnss_;
  std::optional<laser::Scan> scan_;  ///< newest scan
  std::optional<ScanMotion> scan_motion_;
  /// The newest scan fits poorly: where base was is better known after the next one.
  bool next_scan_tells_ = false;
  DeadReckoning motion_;  ///< motion since the newest keyframe
  SlamMap map_;
  SlamTracker tracker_;
  LoopCloser closer_;
  ScanLoopCloser scan_loop_closer_;
  ToldPath told_;
  std::int32_t revision_ = 0;
  std::int64_t scan_utime_ = 0;  ///< utime of the last scan
  std::int64_t driven_us_ = 0;   ///< total time between scans
  std::int64_t lost_us_ = 0;
  std::int64_t ambiguous_us_ = 0;
  bool finished_ = false;
  /// What the fixes showed; set by finish().
  std::string rejected_text_, off_text_, receiver_text_;
};

}  // namespace orchard::pose
