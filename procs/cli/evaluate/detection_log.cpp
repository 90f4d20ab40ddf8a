// SPDX-License-Identifier: BSD-3-Clause
#include "cli/evaluate/detection_log.hpp"

#include <utility>

#include "bus/messages/decode_as.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "detector/detector_node.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/log/log_reader.hpp"
#include "io/progress_bar.hpp"

namespace orchard::cli {
namespace {

using bus::Channel;
using detection::Detections;

bool has_scans(const std::string& path) {
  io::LogReader reader(path);
  while (const auto event = reader.next()) {
    if (event->channel == bus::info(Channel::kScan).name) return true;
    if (event->channel == bus::info(Channel::kDetections).name && reader.num_events() > 1000) {
      return false;
    }
  }
  return false;
}

}  // namespace

std::vector<Detections> read_detections(const std::string& path) {
  io::LogReader reader(io::file_in(path, "derived.lcm"));
  std::vector<Detections> all;
  while (const auto event = reader.next()) {
    if (event->channel != bus::info(Channel::kDetections).name) continue;
    auto detections = bus::decode_as<Detections>(Channel::kDetections, event->data);
    if (detections) all.push_back(std::move(*detections));
  }
  if (all.empty()) {
    throw io::FileError(
        io::file_in(path, "derived.lcm") + " has no valid " +
        std::string(bus::info(Channel::kDetections).name) +
        " message; give a map folder: `orchard map` writes these messages to its derived.lcm");
  }
  return all;
}

std::vector<Detections> detect_log(const std::string& path, const io::Config& config,
                                   bool show_progress) {
  const std::string log = io::file_in(path, "derived.lcm");
  if (!has_scans(log)) return read_detections(log);
  procs::DetectorNode detector(config);
  std::vector<Detections> all;
  io::ProgressBar bar("detecting", show_progress);
  bus::ReplayOptions replay;
  replay.progress = [&](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
  replay.on_derived = [&](Channel channel, std::int64_t, const std::vector<std::uint8_t>& data) {
    if (channel != Channel::kDetections) return;
    if (auto detections = bus::decode_as<Detections>(channel, data)) {
      all.push_back(std::move(*detections));
    }
  };
  bus::replay_in_process(log, {&detector}, replay);
  bar.finish();
  if (all.empty()) throw io::FileError(log + " has no valid scan");
  return all;
}

}  // namespace orchard::cli
