// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/import.hpp"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "bus/bot_core/bot_core_translator.hpp"
#include "bus/messages/codec.hpp"
#include "bus/node/process.hpp"
#include "cli/load_rig.hpp"
#include "cli/long_work.hpp"
#include "cli/parent_folder.hpp"
#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "io/recording/rawlog.hpp"
#include "io/recording/recording_folder.hpp"

namespace orchard::cli {
namespace {

using NextMessage = std::function<std::optional<bus::Message>()>;

struct Imported {
  std::array<std::int64_t, bus::kNumChannels> num_messages{};
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::int64_t num_all = 0;
};

/// `num_all`: how many messages there are, 0 when that is not known.
Imported write_log(const NextMessage& next, std::uint64_t num_all, const std::string& out_path) {
  make_parent_folder(out_path);
  LongWork work("importing messages");
  io::LogWriter writer(out_path);
  Imported imported;
  while (const auto message = next()) {
    const bus::Channel channel = bus::channel_of(*message);
    const std::int64_t utime = bus::utime_of(*message);
    writer.write(utime, bus::info(channel).name, bus::encode(*message));
    if (imported.num_all++ == 0) imported.first_utime = utime;
    imported.last_utime = utime;
    ++imported.num_messages[static_cast<std::size_t>(channel)];
    work.update(static_cast<std::uint64_t>(imported.num_all), num_all);
  }
  work.finish();
  writer.close();
  return imported;
}

void print_imported(const std::string& out_path, const Imported& imported) {
  std::printf("%s: %" PRId64 " messages over %.1f s:", out_path.c_str(), imported.num_all,
              1e-6 * static_cast<double>(imported.last_utime - imported.first_utime));
  for (const bus::ChannelInfo& channel : bus::kChannels) {
    const std::int64_t num = imported.num_messages[static_cast<std::size_t>(channel.channel)];
    if (num > 0) std::printf(" %" PRId64 " %s", num, std::string(channel.name).c_str());
  }
  std::printf("\n");
}

/// Where the laser sat is no message: it belongs into the rig's configuration.
void print_mount(const io::SensorMount& mount) {
  std::printf("the rig's YAML needs: laser: {mount_x_m: %g, mount_y_m: %g, mount_yaw_rad: %g}\n",
              mount.x_m, mount.y_m, mount.yaw_rad);
}

std::optional<bus::Message> as_message(std::optional<io::SensorMessage> sensed) {
  if (!sensed) return std::nullopt;
  return std::visit([](auto&& m) { return bus::Message(std::move(m)); }, *std::move(sensed));
}

/// Whether a file begins as lcm-logger's do.
bool is_lcm_log(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> begin{};
  file.read(begin.data(), begin.size());
  return file && std::string_view(begin.data(), begin.size()) == "\xED\xA1\xDA\x01";
}

void print_ignored(const std::map<std::string, std::int64_t>& ignored) {
  for (const auto& [what, num] : ignored) {
    std::printf("not used: %" PRId64 " x %s\n", num, what.c_str());
  }
}

/// A log of a robot that speaks libbot's types.
int import_bot_core(const ImportOptions& options) {
  const io::Config rig = options.config_path.empty() ? io::Config() : load_rig(options.config_path);
  bus::BotCoreTranslator translator(rig.drivers.bot_core,
                                    static_cast<std::size_t>(rig.drivers.camera.max_bytes));
  io::LogReader log(options.source_path);
  const Imported imported = write_log(
      [&]() -> std::optional<bus::Message> {
        while (const auto event = log.next()) {
          auto message =
              translator.translate(event->channel, event->data.data(), event->data.size());
          if (message) return message;
        }
        return std::nullopt;
      },
      0, options.out_path);
  if (imported.num_all == 0) {
    throw io::FileError(options.source_path +
                        ": holds none of libbot's types (planar_lidar_t, image_t, pose_t, "
                        "gps_data_t); a log of ours needs no import");
  }
  print_imported(options.out_path, imported);
  print_ignored(translator.ignored());
  if (!log.gaps().empty()) {
    std::printf("%zu damaged stretches of %s were passed over\n", log.gaps().size(),
                options.source_path.c_str());
  }
  return bus::kExitOk;
}

}  // namespace

int run_import(const ImportOptions& options) {
  if (std::filesystem::is_directory(options.source_path)) {
    io::RecordingFolder recording(options.source_path);
    print_imported(options.out_path,
                   write_log([&] { return as_message(recording.next()); }, 0, options.out_path));
    print_mount(recording.laser().mount);
    return bus::kExitOk;
  }
  if (is_lcm_log(options.source_path)) return import_bot_core(options);
  const io::RawlogContent rawlog = io::read_rawlog(options.source_path);
  auto next = rawlog.messages.begin();
  print_imported(options.out_path, write_log(
                                       [&]() -> std::optional<bus::Message> {
                                         if (next == rawlog.messages.end()) return std::nullopt;
                                         return as_message(*next++);
                                       },
                                       rawlog.messages.size(), options.out_path));
  if (rawlog.laser_mount) print_mount(*rawlog.laser_mount);
  print_ignored(rawlog.ignored);
  return bus::kExitOk;
}

}  // namespace orchard::cli
