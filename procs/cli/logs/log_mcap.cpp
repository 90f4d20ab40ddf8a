// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <map>
#include <utility>

#include "bus/messages/codec.hpp"
#include "bus/process/process.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/paths.hpp"
#include "io/atomic_file.hpp"
#include "io/bag/foxglove_json.hpp"
#include "io/bag/mcap_writer.hpp"
#include "io/file_error.hpp"
#include "io/log/log_series.hpp"
#include "io/map/stored_map.hpp"
#include "log_player/replay_rig.hpp"

namespace orchard::cli {
namespace {

/// Writes messages to topics with the viewer's schemas.
class Show {
 public:
  Show(std::ostream& out, const io::Config& rig, std::optional<io::StoredMap> map)
      : writer_(out), rig_(rig), map_(std::move(map)) {}

  void take(const bus::Message& message) {
    if (num_taken_++ == 0) begin(bus::utime_of(message));
    std::visit([this](const auto& m) { show(m); }, message);
  }
  void finish() { writer_.finish(); }
  std::uint64_t num_messages() const { return writer_.num_messages(); }
  std::int64_t num_taken() const { return num_taken_; }

 private:
  /// Writes static transforms and the finished map at the start.
  void begin(std::int64_t utime) {
    write("/tf_static", "foxglove.FrameTransforms", utime,
          io::foxglove_mounts(utime, rig_.laser, rig_.camera));
    if (rig_.camera.enabled) {
      write("/camera/calibration", "foxglove.CameraCalibration", utime,
            io::foxglove_calibration(utime, rig_.camera.intrinsics));
    }
    if (!map_) return;
    write("/map", "foxglove.SceneUpdate", utime, io::foxglove_scene(utime, map_->landmarks, {}));
    for (const auto& path : map_->trajectories) {
      write("/map/path", "foxglove.SceneUpdate", utime, io::foxglove_path(utime, path));
      for (const pose::PoseEstimate& pose : path) show_pose(pose);
    }
  }

  void show_pose(const pose::PoseEstimate& pose) {
    write("/tf", "foxglove.FrameTransforms", pose.utime, io::foxglove_transform(pose));
    write("/pose", "foxglove.PoseInFrame", pose.utime, io::foxglove_json(pose));
  }

  void show(const laser::Scan& scan) {
    write("/scan", "foxglove.LaserScan", scan.utime, io::foxglove_json(scan, "laser"));
  }
  void show(const laser::RearScan&) {}  // its frame is not published here
  void show(const vision::Image& image) {
    const bool is_jpeg = image.encoding == vision::Encoding::kJpeg;
    write(is_jpeg ? "/camera" : "/camera/raw",
          is_jpeg ? "foxglove.CompressedImage" : "foxglove.RawImage", image.utime,
          io::foxglove_json(image));
  }
  void show(const pose::Odometry& odometry) {
    write("/odometry", "orchard.Odometry", odometry.utime, io::foxglove_json(odometry));
  }
  void show(const pose::Imu& imu) {
    write("/imu", "orchard.Imu", imu.utime, io::foxglove_json(imu));
  }
  void show(const pose::Gnss& gnss) {
    write("/gnss", "foxglove.LocationFix", gnss.utime, io::foxglove_json(gnss));
  }
  void show(const pose::PoseFix& fix) {
    write("/pose_fix", "foxglove.PoseInFrame", fix.utime, io::foxglove_json(fix));
  }
  // The trajectory of the finished map replaces the recorded poses.
  void show(const pose::PoseEstimate& pose) {
    if (!map_ || map_->trajectories.empty()) show_pose(pose);
  }
  void show(const mapping::MapTile& tile) {
    if (map_) return;
    write("/map", "foxglove.SceneUpdate", tile.utime,
          io::foxglove_scene(tile.utime, tile.landmarks, tile.removed_ids));
  }
  void show(const detection::Detections& detections) {
    write("/detections", "foxglove.SceneUpdate", detections.utime, io::foxglove_scene(detections));
  }
  template <class Message>
  void show(const Message&) {}  // nothing to show

  void write(const char* topic, const char* schema_name, std::int64_t utime,
             const std::string& json) {
    const auto known = topics_.find(topic);
    if (known != topics_.end()) return writer_.write(known->second, utime, json);
    const io::FoxgloveSchema schema = io::foxglove_schema(schema_name);
    writer_.write(topics_[topic] = writer_.add_topic(topic, schema.name, schema.json), utime, json);
  }

  io::McapWriter writer_;
  const io::Config& rig_;
  std::optional<io::StoredMap> map_;
  std::map<std::string, std::uint16_t> topics_;
  std::int64_t num_taken_ = 0;
};

}  // namespace

int run_log_mcap(const LogMcapOptions& options) {
  const io::LogPaths logs(options.log_paths);
  const procs::ReplayRig rig = procs::choose_rig(logs, options.config_path);
  std::optional<io::StoredMap> map;
  if (!options.map_path.empty()) map = io::read_stored_map(options.map_path);
  make_parent_folder(options.out_path);
  InterruptibleWork work("writing");
  std::int64_t num_refused = 0;
  std::uint64_t num_written = 0;
  io::replace_file_atomically(options.out_path, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    Show show(out, rig.config, std::move(map));
    io::LogSeries log(logs);
    while (const auto event = log.next()) {
      work.update(log.position(), log.file_size());
      const auto channel = bus::find_channel(event->channel);
      if (!channel || bus::info(*channel).role == bus::Role::kService) continue;
      const auto decoded = bus::decode(*channel, event->data.data(), event->data.size());
      if (const auto* message = std::get_if<bus::Message>(&decoded)) {
        show.take(*message);
      } else {
        ++num_refused;
      }
    }
    if (show.num_taken() == 0) {
      throw io::FileError(
          logs.text() +
          " has no message that can be converted; see its channels with `orchard log info`");
    }
    show.finish();
    num_written = show.num_messages();
    if (!out)
      throw io::FileError(options.out_path +
                          ": could not be written completely; is the disk full?");
  });
  work.finish();
  std::printf("%s: %" PRIu64 " messages\n", options.out_path.c_str(), num_written);
  if (num_refused > 0) {
    std::fprintf(stderr,
                 "%s: %" PRId64 " messages are invalid and left out (see `orchard log check`)\n",
                 logs.text().c_str(), num_refused);
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
