// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/node.hpp"
#include "io/config/config.hpp"
#include "io/map/map_folder.hpp"
#include "mapper/look_queue.hpp"
#include "mapping/mapper.hpp"
#include "mapping/pose_track.hpp"
#include "pose/filter/gnss_positions.hpp"
#include "pose/trajectory.hpp"

namespace orchard::procs {

/// Puts detections on the map: one MAP tile or more per scan used.
///
/// DETECTIONS(t) wait for a POSE at or after t (with frequent poses: at or after the last object of
/// the scan, so that each is placed at its own time), however the two channels arrive; what has
/// waited mapper.pose_wait_s of message time is counted late and left out. So the map does not
/// depend on how far one channel runs ahead of the other within that time.
///
/// TRAJECTORY corrects the past: poses before its utime move, and once they have moved by
/// kRebuild_m all landmarks are derived anew from their observations, with their ids kept.
/// TRAJECTORY takes its turn before the first DETECTIONS at or after its utime; the end of the log
/// flushes.
///
/// SCAN tells by its beams what stands there no more. DETECTIONS wait for their SCAN likewise, and
/// go without one that does not come; see LookQueue.
///
/// GNSS says where on the earth the map lies: the corrected path is laid upon the fixes.
class MapperNode : public bus::Node {
 public:
  explicit MapperNode(const io::Config& config);

  std::string_view name() const override { return "mapper"; }
  std::vector<bus::Channel> inputs() const override;
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

  /// All of them, however seldom seen.
  std::size_t num_landmarks() const { return mapper_.num_landmarks(); }

 private:
  bool undoes_sweep(const detection::Detections& detections) const;
  bool can_be_placed(const detection::Detections& detections) const;
  void release(const bus::Outbox& send);
  void place_front(const bus::Outbox& send);
  std::optional<geometry::Georeference> georeference() const;
  void correct_up_to(std::int64_t utime, const bus::Outbox& send);
  bool is_worth_rederiving() const;
  void rederive(const bus::Outbox& send);
  void send_landmarks(std::int64_t utime, const std::vector<std::int32_t>& ids,
                      const std::vector<std::int32_t>& removed_ids, const bus::Outbox& send);
  void drop_late(const bus::Outbox& send);
  std::shared_ptr<const mapping::BeamLook> look_of(const detection::Detections& detections,
                                                   const pose::PoseEstimate& T_map_base);
  void use(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
           std::shared_ptr<const mapping::BeamLook> look, const bus::Outbox& send);
  void send_tiles(std::int64_t utime, std::vector<mapping::Landmark> landmarks,
                  const std::vector<std::int32_t>& removed_ids, const bus::Outbox& send);
  std::vector<std::int32_t> refresh_ids(std::int64_t utime);

  mapping::MapperConfig config_;
  Eigen::Vector2d antenna_base_m_;
  pose::GnssPositions gnss_;
  std::vector<pose::GnssPosition> fixes_;
  mapping::Mapper mapper_;
  mapping::PoseTrack track_;
  std::deque<detection::Detections> waiting_;  ///< in order of utime
  LookQueue looks_;
  pose::TrajectoryCollector collector_;
  std::deque<pose::Trajectory> corrections_;  ///< that have not had their turn, in order of utime
  double moved_m_ = 0.0;                      ///< by corrections since landmarks were derived last
  std::size_t num_rederived_ = 0;             ///< observations when that was
  std::optional<std::int64_t> last_used_utime_;
  std::int64_t newest_utime_ = 0;  ///< message time
  bool has_newest_ = false;
  std::int32_t next_seq_ = 0;
  std::int32_t refresh_from_id_ = 1;
  std::int64_t last_refresh_utime_ = 0;
  bus::NodeCounts counts_;
};

}  // namespace orchard::procs
