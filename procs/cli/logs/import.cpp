// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/import.hpp"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "bus/bot_core/bot_core_driver.hpp"
#include "bus/messages/codec.hpp"
#include "bus/process/process.hpp"
#include "cli/logs/import_bags.hpp"
#include "cli/logs/imported_log.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"
#include "io/recording/rawlog.hpp"
#include "io/recording/recording_folder.hpp"

namespace orchard::cli {
namespace {

/// The laser's extrinsics are not a message but belong to the rig's configuration: print them.
void print_mount(const io::SensorMount& mount) {
  std::printf(
      "put the pose of the laser into the rig's YAML: laser: {mount_x_m: %g, mount_y_m: %g, "
      "mount_yaw_rad: %g}\n",
      mount.x_m, mount.y_m, mount.yaw_rad);
}

/// True if a file begins like those of lcm-logger.
bool is_lcm_log(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> begin{};
  file.read(begin.data(), begin.size());
  return file && std::string_view(begin.data(), begin.size()) == "\xED\xA1\xDA\x01";
}

/// Imports a log of a robot with libbot's types.
int import_bot_core(const std::string& source_path, const ImportOptions& options) {
  const io::Config rig =
      options.config_path.empty() ? io::Config() : io::load_config(options.config_path);
  bus::BotCoreTranslator translator(rig.drivers.bot_core,
                                    static_cast<std::size_t>(rig.drivers.camera.max_bytes));
  io::LogReader log(source_path);
  const Imported imported = write_imported(
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
    throw io::FileError(source_path +
                        ": has no message of libbot's types (planar_lidar_t, image_t, pose_t, "
                        "gps_data_t); a log of Orchard Mapper needs no import");
  }
  print_imported(options.out_path, imported);
  print_ignored(translator.ignored());
  if (!log.gaps().empty()) {
    std::printf("%zu damaged parts of %s were skipped\n", log.gaps().size(), source_path.c_str());
  }
  return bus::kExitOk;
}

}  // namespace

int run_import(const ImportOptions& options) {
  const std::string& source_path = options.source_paths.front();
  if (!std::filesystem::exists(source_path)) {
    throw io::FileError(source_path +
                        " does not exist; give a bag, a recording folder, a rawlog or an LCM log");
  }
  const bool is_folder = std::filesystem::is_directory(source_path);
  const bool is_recording = is_folder && std::filesystem::exists(source_path + "/sensors.yaml");
  if (!is_recording &&
      (is_folder ? !io::bag_files(source_path).empty() : io::is_bag(source_path))) {
    return import_bags(options);
  }
  if (options.source_paths.size() > 1) {
    throw io::FileError(source_path +
                        " is not a ROS bag; only bags can be imported several at once");
  }
  if (is_folder) {
    io::RecordingFolder recording(source_path);
    const NextMessage next = [&]() -> std::optional<bus::Message> {
      auto sensed = recording.next();
      if (!sensed) return std::nullopt;
      return as_message(std::move(*sensed));
    };
    print_imported(options.out_path, write_imported(next, 0, options.out_path));
    print_mount(recording.laser().mount);
    return bus::kExitOk;
  }
  if (is_lcm_log(source_path)) return import_bot_core(source_path, options);
  const io::RawlogContent rawlog = io::read_rawlog(source_path);
  auto next = rawlog.messages.begin();
  print_imported(options.out_path, write_imported(
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
