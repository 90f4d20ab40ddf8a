// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "bus/bot_core/bot_core_driver.hpp"
#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"
#include "bus/process/process.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/paths.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/bag_recording.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "io/recording/rawlog.hpp"
#include "io/recording/recording_folder.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

using NextMessage = std::function<std::optional<bus::Message>()>;

/// Numbers of the imported messages and their range of time.
struct Imported {
  std::array<std::int64_t, bus::kNumChannels> num_messages{};
  std::int64_t first_utime = 0;
  std::int64_t last_utime = 0;
  std::int64_t num_all = 0;
  std::int64_t num_repeated = 0;  ///< scans that were left out
};

/// derived: returns of which at most a third agree by chance, in steps as coarse as their noise:
/// all of so many never do.
constexpr std::ptrdiff_t kReturnsMin = 20;

/// Finds scans that a recorder wrote again: no two measurements agree to the last digit of every
/// beam, and when such a scan was measured is not known.
class RepeatedScans {
 public:
  /// True for a scan that equals the one before it; numbers the others on.
  bool contains(bus::Message& message) {
    auto* scan = std::get_if<laser::Scan>(&message);
    if (scan == nullptr) return false;
    const auto num_returns =
        std::count_if(scan->ranges_m.begin(), scan->ranges_m.end(), [scan](float range_m) {
          return range_m > scan->range_min_m && range_m < scan->range_max_m;
        });
    const bool is_repeated = num_returns >= kReturnsMin && scan->ranges_m == last_ranges_m_;
    if (is_repeated) ++num_;
    scan->seq -= num_;
    last_ranges_m_ = scan->ranges_m;
    return is_repeated;
  }
  std::int32_t num() const { return num_; }

 private:
  std::vector<float> last_ranges_m_;
  std::int32_t num_ = 0;
};

inline bus::Message as_message(io::SensorMessage sensed) {
  return std::visit([](auto&& m) { return bus::Message(std::move(m)); }, std::move(sensed));
}

/// Writes messages to a log until `next` returns none. `num_all`: their number, 0 when unknown.
/// Throws io::FileError, Interrupted.
Imported write_imported(const NextMessage& next, std::uint64_t num_all, const std::string& out_path,
                        InterruptibleWork& work) {
  make_parent_folder(out_path);
  io::LogWriter writer(out_path);
  Imported imported;
  RepeatedScans repeated;
  while (auto message = next()) {
    if (repeated.contains(*message)) continue;
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
  imported.num_repeated = repeated.num();
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
  if (imported.num_repeated > 0) {
    std::printf("left out: %" PRId64
                " scans that repeat the scan before them in every beam; "
                "when they were measured is not known\n",
                imported.num_repeated);
  }
}

/// Prints the ignored inputs and their numbers.
void print_ignored(const std::map<std::string, std::int64_t>& ignored) {
  for (const auto& [what, num] : ignored) {
    std::printf("not used: %" PRId64 " x %s\n", num, what.c_str());
  }
}

constexpr std::size_t kMaxKinds = 100;  // max number of different reasons for the report

/// The bag files; those in rosbag2 folders in their order.
std::vector<std::string> files_of(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    const std::vector<std::string> inside = io::bag_files(path);
    if (inside.empty()) throw io::FileError(path + ": this folder has no bag (.bag, .mcap, .db3)");
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

/// The reason why a message is invalid; empty if it is valid.
std::string objection_to(const bus::Message& message) {
  const std::vector<std::uint8_t> bytes = bus::encode(message);
  const auto checked = bus::decode(bus::channel_of(message), bytes.data(), bytes.size());
  const auto* rejection = std::get_if<bus::Rejection>(&checked);
  if (rejection == nullptr) return "";
  return std::string(bus::to_string(rejection->reason)) + " (" + rejection->detail + ")";
}

/// Where sensors sit is no message but belongs to the rig: prints it, and writes it if wanted.
void tell_rig(const io::BagRig& rig, const ImportOptions& options) {
  const std::string& out = options.rig_out_path;
  if (!rig.values.empty()) {
    std::printf(out.empty() ? "for the rig (written by --rig-out FILE):\n" : "rig:\n");
  }
  for (const io::ConfigValue& value : rig.values) {
    std::printf("  %s: %s\n", value.key.c_str(), value.value.c_str());
  }
  for (const std::string& note : rig.notes) std::printf("  %s\n", note.c_str());
  if (out.empty()) return;
  make_parent_folder(out);
  io::edit_config_file(options.config_path, out, rig.values, "orchard import",
                       "of the recording; widths, noise and what is not here are defaults");
  std::printf("written to %s\n", out.c_str());
}

io::BagRig rig_of(const io::SensorMount& mount) {
  constexpr int kDecimals = 6;
  return {{{"laser.mount_x_m", fixed_text(mount.x_m, kDecimals)},
           {"laser.mount_y_m", fixed_text(mount.y_m, kDecimals)},
           {"laser.mount_yaw_rad", fixed_text(mount.yaw_rad, kDecimals)}},
          {}};
}

/// Converts the bags of one drive to an LCM log; returns the exit code. Throws io::FileError.
int import_bags(const ImportOptions& options) {
  io::BagOptions bag_options;
  bag_options.topics = io::parse_topic_choices(options.topics);
  bag_options.slice = {options.slice_height_m, options.slice_thickness_m};
  InterruptibleWork work("importing bags");
  io::BagRecording recording(
      files_of(options.source_paths), bag_options,
      [&work](std::uint64_t done, std::uint64_t total) { work.update(done, total); });
  std::map<bus::Channel, std::int32_t> next_seq;
  std::map<std::string, std::int64_t> refused;
  const Imported imported = write_imported(
      [&]() -> std::optional<bus::Message> {
        while (auto sensed = recording.next()) {
          bus::Message message = as_message(std::move(*sensed));
          const bus::Channel channel = bus::channel_of(message);
          std::visit([seq = next_seq[channel]](auto& m) { m.seq = seq; }, message);
          const std::string objection = objection_to(message);
          if (objection.empty()) {
            ++next_seq[channel];
            return message;
          }
          if (refused.size() < kMaxKinds) {
            ++refused[std::string(bus::info(channel).name) + ": " + objection];
          }
        }
        return std::nullopt;
      },
      recording.num_messages(), options.out_path, work);
  for (const std::string& choice : recording.choices()) std::printf("%s\n", choice.c_str());
  print_imported(options.out_path, imported);
  print_ignored(recording.ignored());
  print_ignored(refused);
  for (const std::string& loss : recording.losses())
    std::fprintf(stderr, "lost: %s\n", loss.c_str());
  if (imported.num_all == 0) {
    throw io::FileError(options.source_paths.front() +
                        ": no message in it can be used; the reasons are listed above");
  }
  tell_rig(recording.rig(), options);
  return bus::kExitOk;
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
  InterruptibleWork work("importing messages");
  const Imported imported = write_imported(
      [&]() -> std::optional<bus::Message> {
        while (const auto event = log.next()) {
          work.update(0, 0);
          auto message =
              translator.translate(event->channel, event->data.data(), event->data.size());
          if (message) return message;
        }
        return std::nullopt;
      },
      0, options.out_path, work);
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
    InterruptibleWork work("importing messages");
    print_imported(options.out_path, write_imported(next, 0, options.out_path, work));
    tell_rig(rig_of(recording.laser().mount), options);
    return bus::kExitOk;
  }
  if (is_lcm_log(source_path)) return import_bot_core(source_path, options);
  const io::RawlogContent rawlog = io::read_rawlog(source_path);
  auto next = rawlog.messages.begin();
  InterruptibleWork work("importing messages");
  print_imported(options.out_path, write_imported(
                                       [&]() -> std::optional<bus::Message> {
                                         if (next == rawlog.messages.end()) return std::nullopt;
                                         return as_message(*next++);
                                       },
                                       rawlog.messages.size(), options.out_path, work));
  tell_rig(rawlog.laser_mount ? rig_of(*rawlog.laser_mount) : io::BagRig(), options);
  print_ignored(rawlog.ignored);
  return bus::kExitOk;
}

}  // namespace orchard::cli
