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
#include "io/bag/mcap_writer.hpp"
#include "io/bag/ros2_messages.hpp"
#include "io/file_error.hpp"
#include "io/log/log_series.hpp"
#include "io/map/stored_map.hpp"
#include "log_player/replay_rig.hpp"
#include "ros/cdr_message.hpp"

namespace orchard::cli {
namespace {

/// Writes a log's messages, and the finished map at its start, as messages of ROS 2.
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
    write(
        io::ros2_mounts(utime, rig_.laser, rig_.laser_rear, rig_.camera, rig_.pose.gnss.antenna_m),
        true);
    if (rig_.camera.enabled) {
      write(io::ros2_camera_info(utime, rig_.camera.intrinsics), true);
    }
    if (!map_) return;
    write(io::ros2_map(utime, map_->landmarks, {}), true);
    for (const auto& path : map_->trajectories) {
      write(io::ros2_path(utime, path), true);
      for (const pose::PoseEstimate& pose : path) write(io::ros2_message(pose));
    }
  }

  // The finished map's trajectory replaces the recorded poses, its landmarks the recorded tiles.
  void show(const pose::PoseEstimate& pose) {
    if (!map_ || map_->trajectories.empty()) write(io::ros2_message(pose));
  }
  void show(const mapping::MapTile& tile) {
    if (!map_) write(io::ros2_map(tile.utime, tile.landmarks, tile.removed_ids));
  }
  template <class Message>
  auto show(const Message& m) -> decltype(void(io::ros2_message(m))) {
    write(io::ros2_message(m));
  }
  void show(...) {}  // nothing to show

  void write(const io::Ros2Message& message, bool is_kept = false) {
    auto& topic = topics_[message.topic];
    if (topic == 0) {
      topic =
          writer_.add_topic(message.topic, message.type, ros::definition_of(message.type), is_kept);
    }
    writer_.write(topic, message.utime, message.cdr);
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
