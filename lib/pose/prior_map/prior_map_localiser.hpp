// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"
#include "pose/prior_map/local_map.hpp"
#include "pose/prior_map/prior_map.hpp"
#include "pose/prior_map/search.hpp"
#include "pose/prior_map/tracker.hpp"

namespace orchard::pose {

/// Finds base in the map of an earlier day, follows it there, and notices when it is elsewhere.
///
/// Without a place it gives no pose: it compares the trunks of the last metres with the whole map
/// and takes a place only when that is likelier than all others together by kLogOddsMin;
/// warning() says LOST (nothing fits) or AMBIGUOUS (several do) until then. With a place it gives
/// poses, and loses it when the trees that should be seen are not, or when the local trunks speak
/// against it. Uses Odometry and Detections.
class PriorMapLocaliser : public Localiser {
 public:
  /// Throws std::invalid_argument with a sentence when nobody can find a place by the landmarks.
  PriorMapLocaliser(const PoseConfig& config, const std::vector<PriorLandmark>& landmarks);
  PriorMapLocaliser(const PriorMapLocaliser&) = delete;
  PriorMapLocaliser& operator=(const PriorMapLocaliser&) = delete;

  void add(const Measurement& measurement) override;
  std::optional<PoseEstimate> estimate() const override;
  std::string warning() const override;

  bool is_tracking() const { return tracking_; }
  std::int64_t num_lost() const { return num_lost_; }

 private:
  void add(const Odometry& odometry);
  void add(const detection::Detections& seen);
  void begin_at(std::int64_t utime);
  void advance_to(std::int64_t utime, double speed_mps, double yaw_rate_radps,
                  const std::array<double, 3>& covariance);
  void advance_to(std::int64_t utime);
  std::array<double, 3> covariance_of(const Odometry& odometry) const;
  double silence_s() const;

  void track(const std::vector<Sighting>& sightings);
  void check_place(bool trees_gone, const TreeWatch::Count& trees);
  void search();
  void judge(const SearchResult& result);
  void lose(const std::string& why, bool forget_trunks);
  void suspect(const std::vector<Sighting>& sightings);
  void begin_anew();
  LocalEvidence evidence(const LocalTrunkMap& local) const;
  std::optional<Place> here(const PlaceScorer& scorer) const;

  PoseConfig pose_config_;
  PriorMapConfig config_;
  PriorMap map_;
  SightField field_;
  LocalTrunkMap local_;
  /// The same since a scan that base may have been moved before: what holds if it was.
  std::optional<LocalTrunkMap> since_suspicion_;
  double suspected_travel_m_ = 0.0;
  PriorMapTracker tracker_;
  std::optional<PriorMapSearch> search_;

  std::optional<std::int64_t> utime_;
  std::optional<Odometry> last_odometry_;
  bool tracking_ = false;
  TreeWatch watch_;
  int num_contradictions_ = 0;
  double checked_travel_m_ = 0.0;  ///< of the last search or check
  std::size_t checked_trunks_ = 0;
  double lost_travel_m_ = 0.0;  ///< where the place was lost, or the beginning
  std::string state_;           ///< why there is no place; empty while there is
  std::int64_t num_lost_ = 0;
};

}  // namespace orchard::pose
