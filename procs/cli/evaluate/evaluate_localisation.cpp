// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/decode_as.hpp"
#include "bus/process/process.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/logs/logs.hpp"
#include "detector/detector_node.hpp"
#include "evaluation/localisation_evaluation.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/log/log_series.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/truth_csv.hpp"
#include "log_player/replay_rig.hpp"
#include "pose/pose_node.hpp"

namespace orchard::cli {
namespace {

using bus::Channel;
using evaluation::PlaceState;

/// The fixes of a log as a track. Throws io::FileError for fewer than two.
evaluation::Track fixes_of(const io::LogPaths& logs) {
  evaluation::Track track;
  io::LogSeries reader(logs);
  while (const auto event = reader.next()) {
    if (event->channel != bus::info(Channel::kPoseFix).name) continue;
    const auto fix = bus::decode_as<pose::PoseFix>(Channel::kPoseFix, event->data);
    if (!fix || (!track.poses.empty() && fix->utime <= track.poses.back().utime)) continue;
    track.has_yaw = track.has_yaw && fix->has_yaw;
    track.poses.push_back({fix->utime, fix->x_m, fix->y_m, fix->yaw_rad});
  }
  if (track.poses.size() < 2) {
    throw io::FileError(
        logs.text() +
        " has no POSE_FIX to compare with; give the true poses with --truth, in the "
        "frame of the map");
  }
  return track;
}

/// What the localisation says of itself while it runs.
class ShadowRecorder {
 public:
  explicit ShadowRecorder(const procs::PoseNode& node) : node_(node) {}

  void take(const pose::PoseEstimate& pose) {
    run_.poses.push_back(pose);
    const bool is_confirmed = node_.warning().rfind("UNCONFIRMED", 0) != 0;
    change(is_confirmed ? PlaceState::kPlaced : PlaceState::kUnconfirmed, pose.utime);
  }
  /// After the scan of that time.
  void take_scan(std::int64_t utime) {
    const std::string warning = node_.warning();
    if (warning.rfind("LOST", 0) == 0) change(PlaceState::kLost, since(utime));
    if (warning.rfind("AMBIGUOUS", 0) == 0) change(PlaceState::kAmbiguous, since(utime));
  }
  evaluation::ShadowRun&& finish() { return std::move(run_); }

 private:
  /// A place is lost from its last pose on, which is older than the scan after which it is told.
  std::int64_t since(std::int64_t utime) const {
    const bool was_placed =
        !run_.states.empty() && run_.states.back().state >= PlaceState::kUnconfirmed;
    return was_placed ? run_.poses.back().utime + 1 : utime;
  }
  void change(PlaceState state, std::int64_t utime) {
    if (!run_.states.empty() && run_.states.back().state == state) return;
    run_.states.push_back({utime, state});
  }

  const procs::PoseNode& node_;
  evaluation::ShadowRun run_;
};

evaluation::ShadowRun run_in_shadow(const io::Config& config,
                                    const EvaluateLocalisationOptions& options) {
  procs::DetectorNode detector(config);
  procs::PoseNode pose_node(config, nullptr);
  ShadowRecorder recorder(pose_node);
  InterruptibleWork work("locating", !options.quiet && !options.json);
  bus::ReplayOptions replay;
  replay.progress = [&](std::uint64_t done, std::uint64_t total) { work.update(done, total); };
  replay.on_derived = [&](Channel channel, std::int64_t utime,
                          const std::vector<std::uint8_t>& data) {
    if (channel == Channel::kDetections) recorder.take_scan(utime);
    if (channel != Channel::kPose) return;
    const auto pose = bus::decode_as<pose::PoseEstimate>(channel, data);
    if (pose) recorder.take(*pose);
  };
  bus::replay_in_process({options.log_paths}, {&detector, &pose_node}, replay);
  work.finish();
  return recorder.finish();
}

}  // namespace

int run_evaluate_localisation(const EvaluateLocalisationOptions& options) {
  const io::LogPaths logs{options.log_paths};
  procs::ReplayRig rig = procs::choose_rig(logs, options.config_path);
  for (const std::string& note : rig.notes) {
    std::fprintf(stderr, "orchard evaluate localisation: note: %s\n", note.c_str());
  }
  rig.config.pose.mode = pose::PoseMode::kPriorMap;
  std::string& map_file = rig.config.pose.prior_map.map_file;
  if (!options.map_path.empty()) map_file = options.map_path;
  if (map_file.empty()) {
    throw io::FileError(rig.name + " names no pose.prior_map.map_file; give a map with --map");
  }
  const evaluation::Track truth =
      options.truth_path.empty() ? fixes_of(logs) : io::read_track_csv(options.truth_path);
  if (truth.poses.size() < 2) {
    throw io::FileError(options.truth_path + " has one pose; a drive needs two or more");
  }
  if (options.start_known) {
    if (!truth.has_yaw) {
      throw io::FileError("the truth has no headings, so --start-known has no pose to start at");
    }
    pose::PriorMapConfig& prior_map = rig.config.pose.prior_map;
    prior_map.start = pose::PriorStart::kGiven;
    prior_map.start_x_m = truth.poses.front().x_m;
    prior_map.start_y_m = truth.poses.front().y_m;
    prior_map.start_yaw_rad = truth.poses.front().yaw_rad;
  }
  const evaluation::ShadowRun run = run_in_shadow(rig.config, options);
  const evaluation::LocalisationEvaluation evaluation =
      evaluation::evaluate_localisation(run, truth, options.truth_sd_m);
  if (!options.out_folder.empty()) {
    io::make_folder(options.out_folder, "choose another folder with --out");
    io::write_file_atomically(options.out_folder + "/localisation.csv",
                              localisation_csv(evaluation));
    io::write_trajectory_csv(options.out_folder + "/trajectory.csv", run.poses);
  }
  std::fputs(
      (options.json ? localisation_json(evaluation) : localisation_summary(evaluation)).c_str(),
      stdout);
  return bus::kExitOk;
}

}  // namespace orchard::cli
