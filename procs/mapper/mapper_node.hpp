// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "io/map/map_folder.hpp"
#include "mapper/beam_times.hpp"
#include "mapper/degradation.hpp"
#include "mapping/album/album.hpp"
#include "mapping/mapper.hpp"
#include "mapping/pose_track.hpp"
#include "pose/filter/gnss_positions.hpp"
#include "pose/trajectory.hpp"
#include "timing/ordered_queue.hpp"

namespace orchard::procs {

/// Puts detections on the map: one MAP tile or more per scan used.
///
/// DETECTIONS(t) wait for a POSE at or after t (with frequent poses: at or after the last object of
/// the scan, so that each is placed at its own time), however the two channels arrive; what has
/// waited mapper.pose_wait_s of message time is counted late and left out. So the map does not
/// depend on how far one channel runs ahead of the other within that time.
///
/// TRAJECTORY corrects the past: poses before its utime move, and once they have moved by
/// kRebuild_m the map is rebuilt from all observations, with its ids kept.
/// TRAJECTORY takes its turn before the first DETECTIONS at or after its utime; the end of the log
/// flushes.
///
/// SCAN is free-space evidence: its beams pass through what stands there no more. One SCAN per
/// mapper.existence.period_s is kept for its DETECTIONS. DETECTIONS(t) wait for a SCAN at or after
/// t; where none has come within mapper.existence.scan_wait_s of message time, nobody waits until
/// SCAN is heard (again): a mapper that is given none works without.
///
/// IMAGE is only cut up for the album (mapper.album): a photograph of each landmark. It holds
/// nothing back, and the map is the same without it.
///
/// GNSS says where on the earth the map lies: the corrected path is laid upon the fixes.
class MapperNode : public bus::Node {
 public:
  /// `memory` holds what a long drive leaves; none: the heap. It changes no output.
  explicit MapperNode(const io::Config& config,
                      const std::shared_ptr<mapping::ChunkMemory>& memory = nullptr);

  std::string_view name() const override { return "mapper"; }
  std::vector<bus::Channel> inputs() const override;
  bus::InputNeed need_of(bus::Channel channel) const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;
  std::string warning() const override;

  /// The map so far, for its files: landmarks with at least mapper.min_observations, numbered by
  /// their rows, and all POSE.
  io::MapFolderContent content(const io::MapSummary& summary) const;

  /// Its landmarks alone, in order of id, not numbered: rows are found over the whole map.
  std::vector<mapping::Landmark> landmarks() const {
    return mapper_.landmarks(config_.min_observations);
  }

  /// The same, numbered by their rows, and what is longer than any scan reports as one: map.csv.
  std::vector<mapping::Landmark> numbered_landmarks() const;

  /// Whether a SCAN of that time would be kept for its DETECTIONS; of others only the time counts.
  bool keeps_beams_of(std::int64_t scan_utime) const;

  /// Whether an IMAGE of that time is looked at; of others nothing depends.
  bool keeps_picture_of(std::int64_t image_utime) const {
    return album_.keeps_picture(image_utime);
  }

  /// All that later outputs depend on; the configuration is the maker's. Throws std::exception when
  /// the memory does not keep what a long drive leaves, or does not have it.
  void persist(mapping::StateArchive& archive);

  /// Grows with every rebuilding of the map, which takes long to do again.
  std::size_t num_rebuilt() const { return num_rebuilt_; }

  /// All of them, however seldom seen.
  std::size_t num_landmarks() const { return mapper_.num_landmarks(); }

 private:
  enum Kind : std::size_t { kTrajectory, kDetections, kScan, kPose, kNumKinds };
  using FreeSpacePtr = std::shared_ptr<mapping::FreeSpace>;
  using Waiting = std::variant<pose::Trajectory, detection::Detections, FreeSpacePtr>;
  using Queue = timing::OrderedQueue<Waiting, kNumKinds>;
  static Queue::Rules rules_of(const mapping::MapperConfig& config);

  std::vector<mapping::Landmark> standing_landmarks() const;
  std::size_t drop_legs(std::vector<mapping::Landmark>& landmarks) const;
  void join_long(std::vector<mapping::Landmark>& landmarks) const;
  const std::string& votes_text() const;
  void add_scan(const laser::Scan& scan);
  void add_gnss(const pose::Gnss& gnss);
  bool undoes_sweep(const detection::Detections& detections) const;
  std::optional<std::size_t> blocker() const;
  void release(const bus::Outbox& send);
  void place_front(const bus::Outbox& send);
  FreeSpacePtr take_free_space(std::int64_t utime);
  std::optional<geometry::Georeference> georeference() const;
  void correct_up_to(std::int64_t utime, const bus::Outbox& send);
  bool is_rebuild_due() const;
  void rebuild_map(const bus::Outbox& send);
  void send_landmarks(std::int64_t utime, const std::vector<std::int32_t>& ids,
                      const std::vector<std::int32_t>& removed_ids, const bus::Outbox& send);
  std::shared_ptr<const mapping::FreeSpace> free_space_of(const detection::Detections& detections,
                                                          const pose::PoseEstimate& T_map_base);
  void use(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
           std::shared_ptr<const mapping::FreeSpace> free_space, const bus::Outbox& send);
  void send_tiles(std::int64_t utime, std::vector<mapping::Landmark> landmarks,
                  const std::vector<std::int32_t>& removed_ids, const bus::Outbox& send);
  std::vector<std::int32_t> refresh_ids(std::int64_t utime);
  void photograph(const detection::Detections& detections, const pose::PoseEstimate& T_map_base);

  mapping::MapperConfig config_;
  Eigen::Vector2d antenna_base_m_;
  pose::GnssPositions gnss_;
  std::vector<pose::GnssPosition> fixes_;
  mapping::Mapper mapper_;
  mapping::PoseTrack track_;
  Queue queue_;
  laser::LaserConfig laser_;
  laser::BlindSector blind_;
  std::int64_t last_kept_scan_utime_ = Queue::kNever;
  bool has_pose_caught_up_ = false;
  bool is_scan_missing_ = false;  ///< DETECTIONS were used without theirs, and none has come since
  mapping::Album album_;
  Degradation degradation_;
  BeamTimes beam_times_;
  bool has_camera_;
  double widest_m_;  ///< that the detector reports whole
  bool has_reflectors_;
  /// Of the reflectors' votes: counting them takes as long as the drive, and so waits for an eighth
  /// of it.
  mutable std::string votes_text_;
  mutable std::size_t num_voted_ = 0;
  std::int32_t last_id_ = 0;  ///< the highest that was given
  bool is_flushed_ = false;
  pose::TrajectoryCollector collector_;
  double moved_m_ = 0.0;         ///< by corrections since the map was rebuilt last
  std::size_t num_rebuilt_ = 0;  ///< observations when that was
  std::optional<std::int64_t> last_used_utime_;
  std::int32_t next_seq_ = 0;
  std::int32_t refresh_from_id_ = 1;
  std::int64_t last_refresh_utime_ = 0;
  bus::NodeCounts counts_;
};

}  // namespace orchard::procs
