// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_node.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/candidate.hpp"
#include "mapping/finish/findings.hpp"
#include "mapping/pose_track.hpp"
#include "timing/units.hpp"

namespace orchard::procs {
namespace {

/// derived: Total motion by corrections above which the map is rebuilt [m]: half of the map's
/// accuracy.
constexpr double kRebuild_m = 0.02;

/// derived: Period of the refresh of the whole MAP in message time [s]: the longest wait of a late
/// joiner.
constexpr double kRefreshPeriod_s = 2.0;

/// derived: Max number of landmarks refreshed per second: larger maps take more than one period.
constexpr double kRefreshMax_per_s = 200.0;

/// derived: Sizes of a tile: with 97 bytes per landmark and 4 per removed id it is well below 60
/// kB.
constexpr std::size_t kLandmarksPerTile = 500;
constexpr std::size_t kRemovedPerTile = 1000;
/// derived: Max number of refreshed landmarks per scan: one more tile.
constexpr std::size_t kRefreshMax = kLandmarksPerTile;

/// derived: How long DETECTIONS wait for the first POSE of all [s]: a GNSS receiver takes time to
/// start, and earlier poses follow once the first pose is known.
constexpr double kFirstPoseWait_s = 60.0;

/// derived: Min duration for an estimate of the velocity from two poses.
constexpr double kSweepMin_s = 0.005;

/// derived: Max number of scans waiting for their DETECTIONS: four minutes, a megabyte.
constexpr std::size_t kScansWaitingMax = 1000;

std::int64_t microseconds(double duration_s) { return static_cast<std::int64_t>(1e6 * duration_s); }

/// How long DETECTIONS wait for their SCAN, which gives free space for landmark existence and for
/// the aisles; none if SCAN is not used.
std::optional<std::int64_t> scan_wait_us(const mapping::MapperConfig& config) {
  const std::int64_t wait_us = microseconds(config.existence.scan_wait_s);
  if (wait_us <= 0) return std::nullopt;
  return wait_us;
}

mapping::MapperConfig with_detector(const io::Config& config) {
  mapping::MapperConfig mapper = config.mapper;
  mapper.min_beams = config.detector.segmentation.min_beams;
  mapper.object_width_max_m = config.detector.segmentation.width_max_m;
  mapper.has_camera = config.camera.enabled;
  mapper.reflector_marks_tree =
      config.detector.segmentation.reflector == laser::ReflectorUse::kOnly;
  return mapper;
}

}  // namespace

MapperNode::MapperNode(const io::Config& config,
                       const std::shared_ptr<mapping::ChunkAllocator>& memory)
    : levelled_(config),
      config_(config.mapper),
      fixes_(config.pose.gnss),
      mapper_(with_detector(config), {config.laser.mount_x_m, config.laser.mount_y_m}, memory),
      track_(config.mapper.pose_gap_max_s, memory),
      queue_(rules_of(config.mapper)),
      laser_(config.laser),
      blind_(config.detector.segmentation.blind_sector()),
      album_(config.mapper.album, detection::Rig(config.laser, config.camera, config.detector)),
      degradation_(config.camera.enabled),
      beam_times_(config.laser.range_sd_m, config.mapper.deskew_pose_gap_max_s),
      has_reflectors_(config.detector.segmentation.reflector != laser::ReflectorUse::kIgnored) {}

/// DETECTIONS wait for POSE and SCAN. GNSS and SCAN arrive independently of the other channels and
/// so do not advance message time.
MapperNode::Queue::Rules MapperNode::rules_of(const mapping::MapperConfig& config) {
  Queue::Rules rules;
  rules[kPose].wait_us = microseconds(std::max(config.pose_wait_s, kFirstPoseWait_s));
  rules[kScan].wait_us = scan_wait_us(config);
  rules[kScan].tells_time = false;
  return rules;
}

std::vector<bus::Channel> MapperNode::inputs() const {
  std::vector<bus::Channel> channels{bus::Channel::kPose, bus::Channel::kDetections,
                                     bus::Channel::kTrajectory, bus::Channel::kGnss};
  if (album_.is_open()) channels.push_back(bus::Channel::kImage);
  if (scan_wait_us(config_)) {
    channels.push_back(bus::Channel::kScan);
    levelled_.add_channels(channels);
  }
  return channels;
}

/// GNSS, free-space evidence and the album are optional.
bus::InputNeed MapperNode::need_of(bus::Channel channel) const {
  const bool optional = channel == bus::Channel::kGnss || channel == bus::Channel::kScan ||
                        channel == bus::Channel::kImage || levelled_.reads(channel);
  return optional ? bus::InputNeed::kOptional : Node::need_of(channel);
}

void MapperNode::handle(const bus::Message& input, const bus::Outbox& send) {
  const auto use = [&](const bus::Message& message) { take(message, send); };
  const auto* scan = std::get_if<laser::Scan>(&input);
  if (!levelled_.is_active() || scan == nullptr || keeps_beams_of(scan->utime)) {
    return levelled_.pass(input, use);
  }
  laser::Scan without_beams;  // whose beams are not levelled in vain
  without_beams.utime = scan->utime;
  without_beams.seq = scan->seq;
  levelled_.pass(without_beams, use);
}

void MapperNode::take(const bus::Message& input, const bus::Outbox& send) {
  is_flushed_ = false;
  finished_.reset();
  const std::int64_t utime = bus::utime_of(input);
  if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) {
    track_.add(*pose);
    queue_.reach(kPose, utime);
  } else if (const auto* detections = std::get_if<detection::Detections>(&input)) {
    if (last_used_utime_ && utime <= *last_used_utime_) {
      ++counts_.num_late;
      return;
    }
    queue_.push(kDetections, utime, *detections);
  } else if (const auto* page = std::get_if<pose::TrajectoryPage>(&input)) {
    queue_.reach(kTrajectory, utime);
    if (auto trajectory = collector_.add(*page)) {
      const std::int64_t corrected_utime = trajectory->utime;
      queue_.push(kTrajectory, corrected_utime, *std::move(trajectory));
    }
  } else if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    add_scan(*scan);
  } else if (const auto* gnss = std::get_if<pose::Gnss>(&input)) {
    return add_gnss(*gnss);
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    return album_.add_picture(*image);
  } else if (std::holds_alternative<pose::Imu>(input)) {
    add_tilt(utime);
  }
  release(send);
}

bool MapperNode::keeps_beams_of(std::int64_t scan_utime) const {
  return last_kept_scan_utime_ == Queue::kNever ||
         scan_utime - last_kept_scan_utime_ >= microseconds(config_.existence.period_s);
}

void MapperNode::add_scan(const laser::Scan& scan) {
  is_scan_missing_ = false;
  queue_.set_wait(kScan, scan_wait_us(config_));
  queue_.reach(kScan, scan.utime);
  if (!keeps_beams_of(scan.utime)) return;
  last_kept_scan_utime_ = scan.utime;
  beam_times_.note_scan(scan);
  queue_.push(kScan, scan.utime, std::make_shared<mapping::FreeSpace>(scan, laser_, blind_));
  if (queue_.size(kScan) > kScansWaitingMax) queue_.take(kScan);
}

void MapperNode::add_gnss(const pose::Gnss& gnss) {
  if (fixes_.add(gnss)) degradation_.note_fix(gnss.utime);
}

void MapperNode::add_tilt(std::int64_t utime) {
  if (!fixes_.wants_tilt_at(utime)) return;
  if (const auto tilt = levelled_.tilt_at(utime)) fixes_.add_tilt(utime, *tilt);
}

bool MapperNode::deskews(const detection::Detections& detections) const {
  const auto gap_max_us = static_cast<std::int64_t>(1e6 * config_.deskew_pose_gap_max_s);
  return gap_max_us > 0 && track_.is_dense_at(detections.utime, gap_max_us);
}

/// The channel that the next DETECTIONS wait for. Depends on whether poses cover their time, not on
/// when the scans arrive.
std::optional<std::size_t> MapperNode::blocker() const {
  const auto& next = std::get<detection::Detections>(queue_.front(kDetections));
  const bool to_last = track_.covers(next.utime) && deskews(next);
  return queue_.blocker(next.utime, [&](std::size_t kind) {
    return kind == kPose && to_last ? mapping::last_utime_of(next) : next.utime;
  });
}

void MapperNode::release(const bus::Outbox& send) {
  const std::int64_t pose_wait_us = microseconds(config_.pose_wait_s);
  if (!has_pose_caught_up_ && queue_.reached(kPose) != Queue::kNever &&
      queue_.message_time() - queue_.reached(kPose) <= pose_wait_us) {
    has_pose_caught_up_ = true;
    queue_.set_wait(kPose, pose_wait_us);
  }
  while (!queue_.is_empty(kDetections) && !blocker()) {
    const std::int64_t utime = queue_.front_utime(kDetections);
    if (track_.covers(utime)) {
      place_front(send);
    } else {  // its POSE has not arrived in time
      last_used_utime_ = utime;
      queue_.take(kDetections);
      ++counts_.num_late;
    }
  }
}

void MapperNode::place_front(const bus::Outbox& send) {
  const auto detections = std::get<detection::Detections>(queue_.take(kDetections));
  // Apply a correction within the sweep first: it moves the poses before it, while later poses are
  // published corrected; the pose would seem to jump between them.
  const bool undoes = deskews(detections);
  correct_up_to(undoes ? mapping::last_utime_of(detections) : detections.utime, send);
  last_used_utime_ = detections.utime;
  const auto pose = track_.at(detections.utime);
  if (!pose) {
    ++(track_.covers(detections.utime) ? counts_.num_unusable : counts_.num_late);
    return;
  }
  beam_times_.note_pose(detections.utime, {pose->x_m, pose->y_m, pose->yaw_rad});
  auto free_space = free_space_of(detections, *pose);
  if (undoes) {
    use(mapping::deskewed(detections, track_, *pose), *pose, std::move(free_space), send);
  } else {
    use(detections, *pose, std::move(free_space), send);
  }
}

/// Takes the free-space evidence of exactly this time, or none; drops older evidence.
MapperNode::FreeSpacePtr MapperNode::take_free_space(std::int64_t utime) {
  if (!scan_wait_us(config_)) return nullptr;
  if (queue_.reached(kScan) < utime) {
    is_scan_missing_ = true;
    queue_.set_wait(kScan, std::nullopt);
  }
  while (!queue_.is_empty(kScan) && queue_.front_utime(kScan) < utime) queue_.take(kScan);
  if (queue_.is_empty(kScan) || queue_.front_utime(kScan) != utime) return nullptr;
  return std::get<FreeSpacePtr>(queue_.take(kScan));
}

/// The beams of a scan with the velocity of base during its sweep; none if the velocity is unknown.
std::shared_ptr<const mapping::FreeSpace> MapperNode::free_space_of(
    const detection::Detections& detections, const pose::PoseEstimate& T_map_base) {
  FreeSpacePtr free_space = take_free_space(detections.utime);
  if (!free_space || !free_space->is_sweep() || !deskews(detections)) return free_space;
  const std::int64_t last_utime = mapping::last_utime_of(detections);
  const double time_s = timing::seconds(last_utime - detections.utime);
  const auto then = track_.at(last_utime);
  if (!then || time_s < kSweepMin_s) return nullptr;
  const geometry::Pose2 T_base_then =
      between(geometry::Pose2{T_map_base.x_m, T_map_base.y_m, T_map_base.yaw_rad},
              geometry::Pose2{then->x_m, then->y_m, then->yaw_rad});
  free_space->set_velocity(T_base_then.vector() / time_s);
  return free_space;
}

void MapperNode::correct_up_to(std::int64_t utime, const bus::Outbox& send) {
  while (!queue_.is_empty(kTrajectory) && queue_.front_utime(kTrajectory) <= utime) {
    moved_m_ += track_.correct(std::get<pose::Trajectory>(queue_.take(kTrajectory)));
  }
  if (is_rebuild_due()) rebuild_map(send);
}

/// A rebuild takes time proportional to the drive. Small corrections wait until the drive has grown
/// by a tenth, so the total cost is limited to ten rebuilds of the whole drive.
bool MapperNode::is_rebuild_due() const {
  if (moved_m_ < kRebuild_m) return false;
  return moved_m_ >= config_.gate_m || 10 * mapper_.num_observations() >= 11 * num_rebuilt_;
}

void MapperNode::rebuild_map(const bus::Outbox& send) {
  moved_m_ = 0.0;
  num_rebuilt_ = mapper_.num_observations();
  const mapping::MapUpdate update = mapper_.rebuild(
      [this](const pose::PoseEstimate& was) { return track_.at(was.utime).value_or(was); });
  send_landmarks(last_used_utime_.value_or(0), update.changed_ids, update.removed_ids, send);
}

void MapperNode::flush(const bus::Outbox& send) {
  levelled_.flush([&](const bus::Message& message) { take(message, send); });
  is_flushed_ = true;
  while (!queue_.is_empty(kDetections)) place_front(send);
  correct_up_to(std::numeric_limits<std::int64_t>::max(), send);
  if (moved_m_ > 0.0) rebuild_map(send);
  album_.flush();
  finished_.reset();
  // The last tiles are the finished map, so that a recorded log ends with it.
  if (has_readers_ && mapper_.num_landmarks() > 0) {
    const mapping::FinishedMap& map = finished();
    std::vector<std::int32_t> omitted_ids;
    for (const mapping::OmittedLandmark& l : map.omitted) omitted_ids.push_back(l.id);
    for (mapping::MapWays& part : mapping::map_ways_of(map, last_used_utime_.value_or(0))) {
      part.seq = next_ways_seq_++;
      send(std::move(part));
    }
    send_tiles(last_used_utime_.value_or(0), map.landmarks, map.landmarks.size(), omitted_ids,
               send);
  }
}

void MapperNode::use(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
                     std::shared_ptr<const mapping::FreeSpace> free_space,
                     const bus::Outbox& send) {
  const mapping::MapUpdate update = mapper_.update(detections, T_map_base, std::move(free_space));
  std::vector<std::int32_t> ids = update.changed_ids;
  if (!ids.empty()) last_id_ = std::max(last_id_, ids.back());
  degradation_.note_scan(detections.utime, detections.image_utime, last_id_);
  if (has_readers_) {
    const std::vector<std::int32_t> refreshed = refresh_ids(detections.utime);
    ids.insert(ids.end(), refreshed.begin(), refreshed.end());
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    send_landmarks(detections.utime, ids, update.removed_ids, send);
  }
  photograph(detections, T_map_base);  // may decode a picture, for which MAP does not wait
}

void MapperNode::send_landmarks(std::int64_t utime, const std::vector<std::int32_t>& ids,
                                const std::vector<std::int32_t>& removed_ids,
                                const bus::Outbox& send) {
  if (!has_readers_) return;
  std::vector<mapping::Landmark> landmarks;
  landmarks.reserve(ids.size());
  for (const std::int32_t id : ids) landmarks.push_back(mapper_.landmark(id));
  send_tiles(utime, landmarks, mapper_.num_landmarks(), removed_ids, send);
}

/// A real reflector is detected in most observations of its landmark, other objects never.
/// Otherwise the threshold lies within the reflectors' returns.
const std::string& MapperNode::label_conflicts_text() const {
  const std::size_t num = mapper_.num_observations();
  if (!has_reflectors_ || (!is_flushed_ && 8 * num < 9 * num_voted_)) return label_conflicts_text_;
  num_voted_ = num;
  const mapping::LabelConflicts conflicts = mapper_.label_conflicts();
  label_conflicts_text_.clear();
  if (conflicts.num_conflicting < 2 ||
      4 * conflicts.num_conflicting < conflicts.num_with_tree_label)
    return label_conflicts_text_;
  label_conflicts_text_ = fmt::format(
      "{} of {} landmarks with a reflector show it in only some scans: look at the intensities "
      "with `orchard echo SCAN` and set detector.segmentation.reflectivity_min between those of "
      "bark and reflector",
      conflicts.num_conflicting, conflicts.num_with_tree_label);
  return label_conflicts_text_;
}

std::string MapperNode::warning() const {
  std::string warning;
  // While running, report only what is missing now; after the flush, all intervals.
  if (is_flushed_) {
    warning = degradation_.text();
  } else if (degradation_.lacks_pictures_now()) {
    warning =
        "DETECTIONS come without pictures (IMAGE): landmarks mapped meanwhile are not classified";
  }
  const auto add = [&](const std::string& text) {
    if (!text.empty()) warning += (warning.empty() ? "" : "; ") + text;
  };
  add(beam_times_.text());
  add(label_conflicts_text());
  const pose::OnEarth& earth = on_earth();
  if (const auto& place = earth.place;
      place && !earth.doubt && place->residual_rms_m > geometry::kGeoreferenceResidualMax_m) {
    add(fmt::format(
        "the GNSS fixes deviate by {:.2f} m (RMS) from the georeferenced map, more "
        "than {:.1f} m: its position on the earth is doubtful, and so is the path if the "
        "receiver errs less",
        place->residual_rms_m, geometry::kGeoreferenceResidualMax_m));
  }
  return warning;
}

std::vector<Finding> MapperNode::findings() const {
  if (const auto& doubt = on_earth().doubt) return {*doubt};
  return {};
}

bus::NodeCounts MapperNode::counts() const {
  bus::NodeCounts counts = counts_;
  counts.num_unusable += collector_.num_incomplete();
  return counts;
}

std::vector<std::int32_t> MapperNode::refresh_ids(std::int64_t utime) {
  // Refresh the whole map once per period, limited to kRefreshMax_per_s.
  const std::int64_t last = std::exchange(last_refresh_utime_, utime);
  if (last == 0 || utime <= last) return {};
  const auto num_landmarks = static_cast<double>(mapper_.num_landmarks());
  const double rate_per_s = std::min(num_landmarks / kRefreshPeriod_s, kRefreshMax_per_s);
  const auto wanted = static_cast<std::size_t>(
      std::ceil(std::min(num_landmarks, rate_per_s * timing::seconds(utime - last))));
  std::vector<std::int32_t> ids = mapper_.ids_from(refresh_from_id_, std::min(wanted, kRefreshMax));
  refresh_from_id_ = ids.empty() ? 1 : ids.back() + 1;
  return ids;
}

void MapperNode::send_tiles(std::int64_t utime, const std::vector<mapping::Landmark>& landmarks,
                            std::size_t num_total, const std::vector<std::int32_t>& removed_ids,
                            const bus::Outbox& send) {
  std::size_t landmark = 0;
  std::size_t removed = 0;
  do {
    mapping::MapTile tile;
    tile.utime = utime;
    tile.seq = next_seq_++;
    tile.num_landmarks_total = static_cast<std::int32_t>(num_total);
    for (; landmark < landmarks.size() && tile.landmarks.size() < kLandmarksPerTile; ++landmark) {
      tile.landmarks.push_back(landmarks[landmark]);
    }
    for (; removed < removed_ids.size() && tile.removed_ids.size() < kRemovedPerTile; ++removed) {
      tile.removed_ids.push_back(removed_ids[removed]);
    }
    send(std::move(tile));
  } while (landmark < landmarks.size() || removed < removed_ids.size());
}

std::string MapperNode::waiting_for() const {
  if (queue_.is_empty(kDetections)) {
    if (queue_.message_time() == Queue::kNever) {
      return "no DETECTIONS and POSE yet (sent by orchard-detector and orchard-pose)";
    }
    return is_scan_missing_
               ? "no SCAN with the DETECTIONS (sent by a laser driver): landmarks that are gone "
                 "stay in the map; start the driver or set mapper.existence.scan_wait_s to 0"
               : "";
  }
  return fmt::format("DETECTIONS at {:.3f} s wait for {}",
                     timing::seconds(timing::utime_of(queue_.front_utime(kDetections))),
                     blocker() == kScan ? "their SCAN (sent by a laser driver)"
                                        : "a POSE of that time or later (sent by orchard-pose)");
}

using mapping::Omission;

pose::PathAt MapperNode::path() const {
  return [this](std::int64_t utime) { return track_.at(utime); };
}

const pose::OnEarth& MapperNode::on_earth() const {
  if (is_flushed_ || 8 * fixes_.size() >= 9 * on_earth_.num_fixes) {
    on_earth_ = fixes_.along(path());
  }
  return on_earth_;
}

const mapping::FinishedMap& MapperNode::finished() const {
  if (!finished_) finished_ = mapping::finish(mapper_, fixes_.along(path()).ground);
  return *finished_;
}

std::vector<mapping::Landmark> MapperNode::finished_landmarks() const {
  if (finished_) return finished_->landmarks;
  return mapping::finish_without_ways(mapper_, on_earth().ground).landmarks;
}

io::MapFolderContent MapperNode::content(const io::MapSummary& summary) const {
  const mapping::FinishedMap& map = finished();
  io::MapFolderContent content;
  content.landmarks = map.landmarks;
  content.rows = map.rows;
  content.graph = map.graph;
  content.trajectory = track_.poses();
  for (pose::PoseEstimate& pose : content.trajectory) pose.utime = timing::utime_of(pose.utime);
  content.summary = summary;
  pose::OnEarth earth = fixes_.along(path());
  if (earth.doubt) content.summary.quality.push_back(*std::move(earth.doubt));
  for (Finding& finding : mapping::findings_of(map.landmarks, config_.rows.has_rows())) {
    content.summary.quality.push_back(std::move(finding));
  }
  const auto count = [&](const char* name, Omission reason) {
    if (const std::size_t num = map.num_omitted(reason); num > 0) {
      content.summary.counts.emplace_back(name, num);
    }
  };
  count("strays_left_out", Omission::kSpurious);
  if (const std::size_t num = map.hidden_tree_ids.size(); num > 0) {
    content.summary.counts.emplace_back("trunks_hidden", num);
  }
  content.photographs = album_.photographs(path());
  content.album_bytes_max = album_.max_bytes();
  content.georeference = earth.place;
  content.degraded = degradation_.intervals();
  content.tree_scatter_m = mapper_.tree_scatter_m();
  return content;
}

namespace {

/// derived: Interval over which the velocity of base is estimated from its poses.
constexpr std::int64_t kMotion_us = 200'000;

constexpr double kMotion_s = 1e-6 * static_cast<double>(kMotion_us);

}  // namespace

void MapperNode::photograph(const detection::Detections& detections,
                            const pose::PoseEstimate& T_map_base) {
  if (!album_.is_open() || detections.image_utime == 0) return;
  std::vector<mapping::Subject> subjects;
  for (const detection::Detection& d : detections.trunks) {
    subjects.push_back({d.centre_x_m, d.centre_y_m, d.width_m, d.occlusion});
  }
  // Use past poses only: the later poses available here depend on the order of arrival.
  detection::Motion motion;
  const auto before = track_.at(detections.utime - kMotion_us);
  if (before && deskews(detections)) {
    const geometry::Pose2 way =
        between(geometry::Pose2{before->x_m, before->y_m, before->yaw_rad},
                geometry::Pose2{T_map_base.x_m, T_map_base.y_m, T_map_base.yaw_rad});
    motion.speed_mps = way.x_m / kMotion_s;
    motion.yaw_rate_radps = way.yaw_rad / kMotion_s;
  }
  album_.add_scan(detections.utime, detections.image_utime, T_map_base, motion,
                  std::move(subjects));
}

}  // namespace orchard::procs
