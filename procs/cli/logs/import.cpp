// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/import.hpp"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <variant>

#include "bus/messages/codec.hpp"
#include "bus/node/process.hpp"
#include "cli/long_work.hpp"
#include "cli/parent_folder.hpp"
#include "io/log/log_writer.hpp"
#include "io/recording/rawlog.hpp"
#include "io/recording/recording_folder.hpp"

namespace orchard::cli {
namespace {

using NextMessage = std::function<std::optional<io::SensorMessage>()>;

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
  while (const auto sensed = next()) {
    const auto message = std::visit([](const auto& m) { return bus::Message(m); }, *sensed);
    const bus::Channel channel = bus::channel_of(message);
    const std::int64_t utime = bus::utime_of(message);
    writer.write(utime, bus::info(channel).name, bus::encode(message));
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

}  // namespace

int run_import(const ImportOptions& options) {
  if (std::filesystem::is_directory(options.source_path)) {
    io::RecordingFolder recording(options.source_path);
    print_imported(options.out_path,
                   write_log([&recording] { return recording.next(); }, 0, options.out_path));
    print_mount(recording.laser().mount);
    return bus::kExitOk;
  }
  const io::RawlogContent rawlog = io::read_rawlog(options.source_path);
  auto next = rawlog.messages.begin();
  print_imported(options.out_path, write_log(
                                       [&]() -> std::optional<io::SensorMessage> {
                                         if (next == rawlog.messages.end()) return std::nullopt;
                                         return *next++;
                                       },
                                       rawlog.messages.size(), options.out_path));
  if (rawlog.laser_mount) print_mount(*rawlog.laser_mount);
  for (const auto& [what, num] : rawlog.ignored) {
    std::printf("not used: %" PRId64 " x %s\n", num, what.c_str());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
