// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_node.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/angles.hpp"
#include "mapping/pose_composition.hpp"
#include "mapping/rows/rows.hpp"
#include "mapping/sweep.hpp"
#include "pose/filter/gnss_alignment.hpp"

namespace orchard::procs {
namespace {

/// 97 bytes per landmark and 4 per removed id on the wire: well below 60 kB.
constexpr std::size_t kLandmarksPerTile = 500;
constexpr std::size_t kRemovedPerTile = 1000;
/// Landmarks that the slow refresh adds to one scan at most: one more tile.
constexpr std::size_t kRefreshMax = kLandmarksPerTile;
constexpr double kFixSpacing_m = 0.5;

/// Over less than this, what base moves does not tell how fast.
constexpr double kSweepMin_s = 0.005;

double seconds(std::int64_t duration_us) { return 1e-6 * static_cast<double>(duration_us); }

}  // namespace

MapperNode::MapperNode(const io::Config& config)
    : config_(config.mapper),
      antenna_base_m_(config.pose.gnss.antenna_m[0], config.pose.gnss.antenna_m[1]),
      gnss_(config.pose.gnss),
      mapper_(config.mapper, {config.laser.mount_x_m, config.laser.mount_y_m}),
      track_(config.mapper.pose_gap_max_s),
      looks_(config) {}

std::vector<bus::Channel> MapperNode::inputs() const {
  std::vector<bus::Channel> channels{bus::Channel::kPose, bus::Channel::kDetections,
                                     bus::Channel::kTrajectory, bus::Channel::kGnss};
  if (looks_.wanted()) channels.push_back(bus::Channel::kScan);
  return channels;
}

void MapperNode::handle(const bus::Message& input, const bus::Outbox& send) {
  if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) {
    track_.add(*pose);
  } else if (const auto* detections = std::get_if<detection::Detections>(&input)) {
    if (last_used_utime_ && detections->utime <= *last_used_utime_) {
      ++counts_.num_late;
      return;
    }
    const auto at = std::upper_bound(
        waiting_.begin(), waiting_.end(), detections->utime,
        [](std::int64_t utime, const detection::Detections& d) { return utime < d.utime; });
    waiting_.insert(at, *detections);
  } else if (const auto* page = std::get_if<pose::TrajectoryPage>(&input)) {
    if (auto trajectory = collector_.add(*page)) corrections_.push_back(*std::move(trajectory));
  } else if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    looks_.add(*scan);
    release(send);
    return;  // it says nothing of how far the others are either
  } else {
    // A receiver runs on whatever the laser does: it says nothing of how far the others are.
    if (const auto* gnss = std::get_if<pose::Gnss>(&input)) {
      const auto fix = gnss_.add(*gnss);
      // A robot that stands tells nothing new, however long it stands.
      if (fix &&
          (fixes_.empty() || (fix->p_enu_m - fixes_.back().p_enu_m).norm() > kFixSpacing_m)) {
        fixes_.push_back(*fix);
      }
    }
    return;
  }
  newest_utime_ =
      has_newest_ ? std::max(newest_utime_, bus::utime_of(input)) : bus::utime_of(input);
  has_newest_ = true;
  release(send);
  drop_late(send);
}

bool MapperNode::undoes_sweep(const detection::Detections& detections) const {
  const auto gap_max_us = static_cast<std::int64_t>(1e6 * config_.sweep_pose_gap_max_s);
  return gap_max_us > 0 && track_.is_dense_at(detections.utime, gap_max_us);
}

/// By what has come for its time, so that it does not depend on when the scans come.
bool MapperNode::can_be_placed(const detection::Detections& detections) const {
  if (!track_.covers(detections.utime)) return false;
  if (!looks_.is_ready(detections.utime, newest_utime_)) return false;
  return !undoes_sweep(detections) || track_.covers(mapping::last_utime_of(detections));
}

void MapperNode::release(const bus::Outbox& send) {
  while (!waiting_.empty() && can_be_placed(waiting_.front())) place_front(send);
}

void MapperNode::place_front(const bus::Outbox& send) {
  const detection::Detections detections = std::move(waiting_.front());
  waiting_.pop_front();
  correct_up_to(detections.utime, send);
  last_used_utime_ = detections.utime;
  const auto pose = track_.at(detections.utime);
  if (!pose) {
    ++(track_.covers(detections.utime) ? counts_.num_unusable : counts_.num_late);
    return;
  }
  auto look = look_of(detections, *pose);
  if (undoes_sweep(detections)) {
    use(mapping::unswept(detections, track_, *pose), *pose, std::move(look), send);
  } else {
    use(detections, *pose, std::move(look), send);
  }
}

/// The beams of a scan, and how base moved from its first object to its last while they were sent.
/// None where that cannot be told.
std::shared_ptr<const mapping::BeamLook> MapperNode::look_of(
    const detection::Detections& detections, const pose::PoseEstimate& T_map_base) {
  auto look = looks_.take(detections.utime);
  if (!look || !look->is_sweep() || !undoes_sweep(detections)) return look;
  const std::int64_t last_utime = mapping::last_utime_of(detections);
  const double time_s = seconds(last_utime - detections.utime);
  const auto then = track_.at(last_utime);
  if (!then || time_s < kSweepMin_s) return nullptr;
  const double x_m = then->x_m - T_map_base.x_m, y_m = then->y_m - T_map_base.y_m;
  const double c = std::cos(T_map_base.yaw_rad), s = std::sin(T_map_base.yaw_rad);
  const double yaw_rad = geometry::wrap_angle_rad(then->yaw_rad - T_map_base.yaw_rad);
  look->set_velocity(Eigen::Vector3d(c * x_m + s * y_m, c * y_m - s * x_m, yaw_rad) / time_s);
  return look;
}

void MapperNode::correct_up_to(std::int64_t utime, const bus::Outbox& send) {
  while (!corrections_.empty() && corrections_.front().utime <= utime) {
    moved_m_ += track_.correct(corrections_.front());
    corrections_.pop_front();
  }
  if (is_worth_rederiving()) rederive(send);
}

/// All of it costs as much as the drive is long: small corrections wait until the drive has grown
/// by a tenth, so that all of them together cost no more than ten drives.
bool MapperNode::is_worth_rederiving() const {
  if (moved_m_ < config_.rederive_m) return false;
  return moved_m_ >= config_.gate_m || 10 * mapper_.num_observations() >= 11 * num_rederived_;
}

void MapperNode::rederive(const bus::Outbox& send) {
  moved_m_ = 0.0;
  num_rederived_ = mapper_.num_observations();
  const mapping::MapUpdate update = mapper_.rederive(
      [this](const pose::PoseEstimate& was) { return track_.at(was.utime).value_or(was); });
  send_landmarks(last_used_utime_.value_or(0), update.changed_ids, update.removed_ids, send);
}

void MapperNode::drop_late(const bus::Outbox& send) {
  while (!waiting_.empty() &&
         seconds(newest_utime_ - waiting_.front().utime) > config_.pose_wait_s) {
    if (track_.covers(waiting_.front().utime)) {
      place_front(send);  // the pose at its last beam has not come
      continue;
    }
    last_used_utime_ = waiting_.front().utime;
    waiting_.pop_front();
    ++counts_.num_late;
  }
}

void MapperNode::flush(const bus::Outbox& send) {
  while (!waiting_.empty()) place_front(send);
  correct_up_to(std::numeric_limits<std::int64_t>::max(), send);
  if (moved_m_ > 0.0) rederive(send);
  // the whole map once more, so that a recorded log ends with it
  if (mapper_.num_landmarks() > 0) {
    std::vector<mapping::Landmark> all = mapper_.landmarks();
    if (config_.rows.enabled) {
      mapping::number_landmarks(mapping::find_rows(landmarks(), config_.rows), all);
    }
    send_tiles(last_used_utime_.value_or(0), std::move(all), {}, send);
  }
}

void MapperNode::use(const detection::Detections& detections, const pose::PoseEstimate& T_map_base,
                     std::shared_ptr<const mapping::BeamLook> look, const bus::Outbox& send) {
  const mapping::MapUpdate update = mapper_.update(detections, T_map_base, std::move(look));
  std::vector<std::int32_t> ids = update.changed_ids;
  const std::vector<std::int32_t> refreshed = refresh_ids(detections.utime);
  ids.insert(ids.end(), refreshed.begin(), refreshed.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  send_landmarks(detections.utime, ids, update.removed_ids, send);
}

void MapperNode::send_landmarks(std::int64_t utime, const std::vector<std::int32_t>& ids,
                                const std::vector<std::int32_t>& removed_ids,
                                const bus::Outbox& send) {
  std::vector<mapping::Landmark> landmarks;
  landmarks.reserve(ids.size());
  for (const std::int32_t id : ids) landmarks.push_back(mapper_.landmark(id));
  send_tiles(utime, std::move(landmarks), removed_ids, send);
}

std::optional<geometry::Georeference> MapperNode::georeference() const {
  std::vector<pose::AntennaSight> sights;
  for (const pose::GnssPosition& fix : fixes_) {
    const auto pose = track_.at(fix.utime);
    if (!pose) continue;
    pose::AntennaSight sight;
    sight.p_enu_m = fix.p_enu_m;
    sight.p_map_m = mapping::PoseComposition(*pose).apply(antenna_base_m_.x(), antenna_base_m_.y());
    sight.variance_m2 = 0.5 * fix.covariance.trace();
    sights.push_back(sight);
  }
  const auto alignment = pose::align_to_gnss(sights);
  if (!alignment) return std::nullopt;
  const std::array<double, 3> datum = gnss_.datum().value();
  geometry::Georeference georeference;
  georeference.latitude_deg = datum[0];
  georeference.longitude_deg = datum[1];
  georeference.altitude_m = datum[2];
  georeference.x_m = alignment->x_y_yaw.x();
  georeference.y_m = alignment->x_y_yaw.y();
  georeference.yaw_rad = alignment->x_y_yaw.z();
  georeference.residual_rms_m = alignment->residual_rms_m;
  return georeference;
}

std::string MapperNode::warning() const {
  const auto place = fixes_.empty() ? std::nullopt : georeference();
  if (!place || place->residual_rms_m <= geometry::kGeoreferenceResidualMax_m) return {};
  return fmt::format(
      "the satellite fixes lie {:.2f} m about the map that they place (more than {:.1f} m)",
      place->residual_rms_m, geometry::kGeoreferenceResidualMax_m);
}

bus::NodeCounts MapperNode::counts() const {
  bus::NodeCounts counts = counts_;
  counts.num_unusable += collector_.num_incomplete();
  return counts;
}

std::vector<std::int32_t> MapperNode::refresh_ids(std::int64_t utime) {
  // as many per scan as bring the whole map round once per period, or as may be per second
  const std::int64_t last = std::exchange(last_refresh_utime_, utime);
  if (last == 0 || utime <= last) return {};
  const auto num_landmarks = static_cast<double>(mapper_.num_landmarks());
  const double rate_per_s =
      std::min(num_landmarks / config_.refresh_period_s, config_.refresh_per_s);
  const auto wanted = static_cast<std::size_t>(
      std::ceil(std::min(num_landmarks, rate_per_s * seconds(utime - last))));
  std::vector<std::int32_t> ids = mapper_.ids_from(refresh_from_id_, std::min(wanted, kRefreshMax));
  refresh_from_id_ = ids.empty() ? 1 : ids.back() + 1;
  return ids;
}

void MapperNode::send_tiles(std::int64_t utime, std::vector<mapping::Landmark> landmarks,
                            const std::vector<std::int32_t>& removed_ids, const bus::Outbox& send) {
  std::size_t landmark = 0;
  std::size_t removed = 0;
  do {
    mapping::MapTile tile;
    tile.utime = utime;
    tile.seq = next_seq_++;
    tile.num_landmarks_total = static_cast<std::int32_t>(mapper_.num_landmarks());
    for (; landmark < landmarks.size() && tile.landmarks.size() < kLandmarksPerTile; ++landmark) {
      tile.landmarks.push_back(std::move(landmarks[landmark]));
    }
    for (; removed < removed_ids.size() && tile.removed_ids.size() < kRemovedPerTile; ++removed) {
      tile.removed_ids.push_back(removed_ids[removed]);
    }
    send(std::move(tile));
  } while (landmark < landmarks.size() || removed < removed_ids.size());
}

std::string MapperNode::waiting_for() const {
  if (waiting_.empty()) {
    if (!has_newest_) return "no DETECTIONS and no POSE yet (orchard-detector, orchard-pose)";
    return looks_.is_missing()
               ? "no SCAN with the DETECTIONS (a laser driver): what is gone is told "
                 "from DETECTIONS alone (or set mapper.presence.scan_wait_s to 0)"
               : "";
  }
  const std::int64_t utime = waiting_.front().utime;
  return fmt::format("DETECTIONS at {:.3f} s wait for {}", seconds(utime),
                     looks_.is_ready(utime, newest_utime_) ? "a POSE at or after (orchard-pose)"
                                                           : "their SCAN (a laser driver)");
}

io::MapFolderContent MapperNode::content(const io::MapSummary& summary) const {
  io::MapFolderContent content{landmarks(), track_.poses(), summary, {}};
  if (config_.rows.enabled) {
    content.rows = mapping::find_rows(content.landmarks, config_.rows);
    mapping::number_landmarks(content.rows, content.landmarks);
  }
  content.georeference = georeference();
  content.tree_scatter_m = mapper_.tree_scatter_m();
  return content;
}

}  // namespace orchard::procs
