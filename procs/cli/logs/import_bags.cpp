// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/import_bags.hpp"

#include <cstdio>
#include <filesystem>
#include <map>
#include <utility>

#include "bus/messages/codec.hpp"
#include "bus/process/process.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/logs/imported_log.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/bag_recording.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

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

}  // namespace

int import_bags(const ImportOptions& options) {
  io::BagOptions bag_options;
  bag_options.topics = io::parse_topic_choices(options.topics);
  bag_options.slice = {options.slice_height_m, options.slice_thickness_m};
  InterruptibleWork work("scanning bags");
  io::BagRecording recording(
      files_of(options.source_paths), bag_options,
      [&work](std::uint64_t done, std::uint64_t total) { work.update(done, total); });
  work.finish();
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
      recording.num_messages(), options.out_path);
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
  return bus::kExitOk;
}

}  // namespace orchard::cli
