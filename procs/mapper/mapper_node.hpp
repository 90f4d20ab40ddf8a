// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bus/node/levelled_inputs.hpp"
#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "io/map/map_folder.hpp"
#include "mapper/degradation.hpp"
#include "mapping/album/album.hpp"
#include "mapping/finish/finish.hpp"
#include "mapping/finish/map_ways.hpp"
#include "mapping/mapper.hpp"
#include "mapping/pose_track.hpp"
#include "pose/filter/on_earth.hpp"
#include "pose/pose_estimate.hpp"
#include "timing/ordered_queue.hpp"

namespace orchard::procs {

/// Maps detections: one MAP tile or more per scan used.
///
/// DETECTIONS(t) wait for a POSE at or after t, in whatever order the two channels arrive; with
/// frequent poses they wait for a POSE at or after the last object of the scan, so that each object
/// is placed with the pose of its own time. DETECTIONS that have waited mapper.pose_wait_s of
/// message time are counted late and dropped. Within that time the map does not depend on how far
/// one channel is ahead of the other.
///
/// TRAJECTORY corrects the past: poses before its utime move. Once they have moved by kRebuild_m,
/// the map is rebuilt from all observations, with its ids kept. A TRAJECTORY is applied before the
/// first DETECTIONS at or after its utime; the end of the log flushes.
///
/// SCAN is free-space evidence: a beam that passes through a landmark's position is evidence of its
/// absence. One SCAN per mapper.existence.period_s is kept for its DETECTIONS. DETECTIONS(t) wait
/// for a SCAN at or after t. If none arrives within mapper.existence.scan_wait_s of message time,
/// waiting stops until the next SCAN: a mapper without SCAN works without this evidence.
///
/// IMAGE is used only for the album (mapper.album), a photograph of each landmark. DETECTIONS do
/// not wait for it, and the map does not depend on it.
///
/// GNSS gives the georeference: the corrected path is fitted to the fixes. With the tilt where
/// scans are levelled it gives the heights of the ground. Where the path lies beside the fixes it
/// tells so.
class MapperNode : public bus::Node {
 public:
  /// `memory` stores the data of a long drive; none: the heap. It changes no output.
  explicit MapperNode(const io::Config& config,
                      const std::shared_ptr<mapping::ChunkAllocator>& memory = nullptr);

  std::string_view name() const override { return "mapper"; }
  std::vector<bus::Channel> inputs() const override;
  bus::InputNeed need_of(bus::Channel channel) const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;
  std::string warning() const override;
  std::vector<Finding> findings() const override;

  /// Content of the map's files: the finished map, and all POSE.
  io::MapFolderContent content(const io::MapSummary& summary) const;

  /// The landmarks with at least mapper.min_observations, in order of id: not yet finished.
  std::vector<mapping::Landmark> landmarks() const {
    return mapper_.landmarks(config_.min_observations);
  }

  /// The finished map of the inputs so far: what every file shows, and MAP after the flush. Kept
  /// until the next input.
  const mapping::FinishedMap& finished() const;

  /// Its landmarks alone, in a fraction of the time; heights by the fixes of eight ninths of the
  /// drive at least.
  std::vector<mapping::Landmark> finished_landmarks() const;

  /// The ways of the map with other numbers, on ground that the scans saw free.
  mapping::NavigationGraph ways_of(const std::vector<mapping::Landmark>& landmarks,
                                   const std::vector<mapping::Row>& rows) const {
    return mapping::navigation_graph_of(landmarks, rows, *mapper_.ground());
  }

  /// True if the beams of a SCAN of this time are kept for its DETECTIONS; of other SCANs only the
  /// time is used.
  bool keeps_beams_of(std::int64_t scan_utime) const;

  /// True if an IMAGE of this time is used; others have no effect.
  bool keeps_picture_of(std::int64_t image_utime) const {
    return album_.keeps_picture(image_utime);
  }

  /// Whether anyone reads MAP; false: none is sent, and its landmarks are not computed. The content
  /// of the map is the same.
  void set_has_readers(bool has_readers) { has_readers_ = has_readers; }

  /// Number of all POSE.
  std::size_t num_poses() const { return track_.size(); }

  /// Number of all landmarks, including those with few observations.
  std::size_t num_landmarks() const { return mapper_.num_landmarks(); }

 private:
  enum Kind : std::size_t { kTrajectory, kDetections, kScan, kPose, kNumKinds };
  using FreeSpacePtr = std::shared_ptr<mapping::FreeSpace>;
  using Waiting = std::variant<pose::Trajectory, detection::Detections, FreeSpacePtr>;
  using Queue = timing::OrderedQueue<Waiting, kNumKinds>;
  static Queue::Rules rules_of(const mapping::MapperConfig& config);

  void take(const bus::Message& input, const bus::Outbox& send);
  const std::string& label_conflicts_text() const;
  /// Reading it takes time proportional to the drive, so it is repeated only after growth by an
  /// eighth.
  const pose::OnEarth& on_earth() const;
  pose::PathAt path() const;
  void add_scan(const laser::Scan& scan);
  void add_gnss(const pose::Gnss& gnss);
  void add_tilt(std::int64_t utime);
  bool deskews(const detection::Detections& detections) const;
  std::optional<std::size_t> blocker() const;
  void release(const bus::Outbox& send);
  void place_front(const bus::Outbox& send);
  FreeSpacePtr take_free_space(std::int64_t utime);
  void correct_up_to(std::int64_t utime, const bus::Outbox& send);
  bool is_rebuild_due() const;
  void rebuild_map(const bus::Outbox& send);
  void send_landmarks(std::int64_t utime, const std::vector<std::int32_t>& ids,
                      const std::vector<std::int32_t>& removed_ids, const bus::Outbox& send);
  std::shared_ptr<const mapping::FreeSpace> free_space_of(const detection::Detections& detections,
                                                          const pose::PoseEstimate& T_map_base);
  void use(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
           std::shared_ptr<const mapping::FreeSpace> free_space, const bus::Outbox& send);
  void send_tiles(std::int64_t utime, const std::vector<mapping::Landmark>& landmarks,
                  std::size_t num_total, const std::vector<std::int32_t>& removed_ids,
                  const bus::Outbox& send);
  std::vector<std::int32_t> refresh_ids(std::int64_t utime);
  void photograph(const detection::Detections& detections, const pose::PoseEstimate& T_map_base);

  bus::LevelledInputs levelled_;
  mapping::MapperConfig config_;
  pose::FixesOfDrive fixes_;
  mapping::Mapper mapper_;
  mapping::PoseTrack track_;
  Queue queue_;
  laser::LaserConfig laser_;
  laser::BlindSector blind_;
  std::int64_t last_kept_scan_utime_ = Queue::kNever;
  bool has_pose_caught_up_ = false;
  bool is_scan_missing_ = false;  ///< DETECTIONS lacked their SCAN, and none has come since
  mapping::Album album_;
  Degradation degradation_;
  BeamTimes beam_times_;
  bool has_reflectors_;
  /// Warning about inconsistent reflector detections. Counting them takes time proportional to the
  /// drive, so it is repeated only after growth by an eighth.
  mutable std::string label_conflicts_text_;
  mutable std::size_t num_voted_ = 0;
  mutable pose::OnEarth on_earth_;
  mutable std::optional<mapping::FinishedMap> finished_;  ///< of the inputs so far
  std::int32_t last_id_ = 0;                              ///< highest landmark id so far
  bool is_flushed_ = false;
  bool has_readers_ = true;  ///< of MAP
  pose::TrajectoryCollector collector_;
  double moved_m_ = 0.0;         ///< motion by corrections since the last rebuild
  std::size_t num_rebuilt_ = 0;  ///< number of observations at the last rebuild
  std::optional<std::int64_t> last_used_utime_;
  std::int32_t next_seq_ = 0;       ///< of MAP
  std::int32_t next_ways_seq_ = 0;  ///< of MAP_WAYS
  std::int32_t refresh_from_id_ = 1;
  std::int64_t last_refresh_utime_ = 0;
  bus::NodeCounts counts_;
};

}  // namespace orchard::procs
