// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"
#include "pose/prior_map/local_map.hpp"
#include "pose/prior_map/place_belief.hpp"
#include "pose/prior_map/prior_map.hpp"
#include "pose/prior_map/search.hpp"
#include "pose/prior_map/tracker.hpp"
#include "pose/scan_matching/scan_motion.hpp"

namespace orchard::pose {

/// Localiser of pose.mode prior_map: finds base in the map of an earlier day, tracks it there, and
/// detects when the position is wrong.
///
/// While searching it gives no pose. It compares the trunks of the last metres with the whole map
/// and accepts a position only when it is more likely than all others together by kLogOddsMin;
/// until then warning() says LOST (nothing fits) or AMBIGUOUS (several positions fit). While
/// tracking it gives poses, and returns to searching if expected trees are missing or the local
/// trunks contradict the position. In a map of some hundred trees it weighs all places beside the
/// search. A position that has become vague is AMBIGUOUS, without a pose, until the trunks tell it
/// again; a stated start is UNCONFIRMED, with a pose, until they have told it, and so is a place
/// whose last motion scans could not confirm. Uses Detections and Odometry, or scans with
/// `motion: scans`.
class PriorMapLocaliser : public Localiser {
 public:
  /// Throws std::invalid_argument if the landmarks are not suitable (see problem_with). `mount` and
  /// `blind` are used with `motion: scans` only.
  PriorMapLocaliser(const PoseConfig& config, const PriorMapData& earlier,
                    const laser::LaserConfig& mount = {}, const laser::BlindSector& blind = {});
  PriorMapLocaliser(const PriorMapLocaliser&) = delete;
  PriorMapLocaliser& operator=(const PriorMapLocaliser&) = delete;

  void add(const Measurement& measurement) override;
  std::optional<PoseEstimate> estimate() const override;
  std::string warning() const override;

  std::int64_t num_lost() const { return num_lost_; }

 private:
  void add(const Odometry& odometry);
  void add(const laser::Scan& scan);
  void add(const detection::Detections& seen);
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance);
  void begin_at(std::int64_t utime);
  void advance_to(std::int64_t utime, double speed_mps, double yaw_rate_radps,
                  const std::array<double, 3>& covariance);
  void advance_to(std::int64_t utime);
  std::array<double, 3> covariance_of(const Odometry& odometry) const;
  double time_since_motion_s() const;
  std::string place_warning() const;
  std::string motion_warning() const;

  void track(const std::vector<ScanObservation>& observations);
  bool is_vague(const Eigen::Matrix3d& covariance) const;
  void believe_anywhere(const std::vector<ScanObservation>& observations);
  void become_vague();
  void leave_tracker();
  void watch_belief(const std::vector<ScanObservation>& observations);
  void place_at(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);
  void check_present_pose(const TreeDetectionMonitor::Count& trees);
  void search();
  void decide_on_result(const SearchResult& result);
  void declare_lost(const std::string& why, bool forget_trunks);
  void watch_for_kidnapping(const std::vector<ScanObservation>& observations);
  void restart_local_map();
  LocalEvidence evidence(const LocalTrunkMap& local) const;
  LocalEvidence nearby_evidence(const LocalTrunkMap& local) const;
  PoseHypothesis present_hypothesis(const HypothesisScorer& scorer) const;

  PoseConfig pose_config_;
  PriorMapConfig config_;
  PriorMap map_;
  FieldOfView field_;
  LocalTrunkMap local_;
  /// Second local map, started at a scan before which the robot may have been carried.
  std::optional<LocalTrunkMap> since_kidnapping_;
  double kidnapping_travel_m_ = 0.0;
  PriorMapTracker tracker_;
  /// In place of the tracker where trunks look alike, then beside it to doubt the place.
  std::optional<PlaceBelief> belief_;
  /// Distance from a landmark [m] within which the map has too many places to weigh.
  double too_far_m_ = std::numeric_limits<double>::infinity();
  bool must_be_tested_ = false;           ///< the place of belief_ may be one of another orchard
  bool is_confirmed_ = false;             ///< the belief has come to the tracker's place
  std::optional<PriorMapSearch> search_;  ///< for a position

  std::optional<std::int64_t> utime_;
  std::optional<Odometry> last_odometry_;
  std::optional<ScanMotion> scan_motion_;  ///< with motion: scans
  MeasuredMotion last_motion_;             ///< by the last scan
  int num_unreliable_ = 0;                 ///< consecutive scans without a reliable motion
  bool tracking_ = false;
  TreeDetectionMonitor watch_;
  int num_contradictions_ = 0;
  double checked_travel_m_ = 0.0;  ///< travel at the last search or check
  std::size_t checked_trunks_ = 0;
  double lost_travel_m_ = 0.0;  ///< travel at which the position was lost; initially 0
  std::string state_;           ///< why there is no position; empty while tracking
  std::int64_t num_lost_ = 0;
};

}  // namespace orchard::pose
