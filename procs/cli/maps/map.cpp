// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/maps.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/decode_as.hpp"
#include "bus/process/process.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "bus/replay/logged_rig.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/maps/map_pipeline.hpp"
#include "cli/maps/stored_maps.hpp"
#include "cli/rig/learn.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config.hpp"
#include "io/figure/scan_figure.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/log/log_series.hpp"
#include "io/log/log_writer.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/map_folder.hpp"
#include "log_player/replay_rig.hpp"
#include "mapping/kind.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "pose/pose_config.hpp"

namespace orchard::cli {
namespace {

constexpr std::int64_t kStretch = 1000;

/// Peak memory of this process [MiB]; 0 where the system does not report it.
double peak_mib() {
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    double kib = 0.0;
    if (std::sscanf(line.c_str(), "VmHWM: %lf kB", &kib) == 1) return kib / 1024.0;
  }
  return 0.0;
}

/// Measures the cost of a long replay: processor time per scan and memory, per thousand scans.
/// Printed only; it reaches no file.
class ScanTimer {
 public:
  /// Counts one processed scan.
  void count() {
    if (++num_scans_ % kStretch != 0) return;
    const std::clock_t now = std::clock();
    stretches_.push_back({num_scans_ - kStretch + 1, num_scans_,
                          1e3 * static_cast<double>(now - begin_) / CLOCKS_PER_SEC / kStretch,
                          peak_mib()});
    begin_ = now;
  }

  /// One line per thousand: `timing: scans 1-1000: 0.912 ms a scan, 43.1 MiB at most`; and one of
  /// the most memory up to now, the files that were written included.
  std::string text() const {
    std::string text;
    for (const Stretch& s : stretches_) {
      text += fmt::format("timing: scans {}-{}: {:.3f} ms a scan, {:.1f} MiB at most\n", s.first,
                          s.last, s.ms_per_scan, s.peak_mib);
    }
    return text + fmt::format("timing: in all: {:.1f} MiB at most\n", peak_mib());
  }

 private:
  struct Stretch {
    std::int64_t first, last;
    double ms_per_scan;
    double peak_mib;
  };
  std::int64_t num_scans_ = 0;
  std::clock_t begin_ = std::clock();
  std::vector<Stretch> stretches_;
};

using pose::PoseMode;

bool can_read_scans(PoseMode mode) {
  return mode == PoseMode::kOdometry || mode == PoseMode::kSlam || mode == PoseMode::kPriorMap;
}

/// The reason why a drive gave no pose at all, as text that completes "LOG ...": the mode, its
/// missing inputs, and the keys to set. `missing`: required channels without messages; `state`: the
/// mode's own message, or empty.
std::string no_pose_text(const pose::PoseConfig& config, const std::vector<bus::Channel>& missing,
                         const std::string& state) {
  constexpr const char* kModes[] = {"fixes", "fixes_and_odometry", "odometry", "stationary",
                                    "fused", "prior_map",          "slam"};
  std::string text =
      std::string("yields no pose: pose.mode ") + kModes[static_cast<int>(config.mode)];
  std::string channels;
  for (const bus::Channel channel : missing) {
    channels += (channels.empty() ? "" : ", ") + std::string(bus::info(channel).name);
  }
  if (!channels.empty()) text += " needs " + channels + ", which the log lacks";
  const bool no_wheels =
      std::find(missing.begin(), missing.end(), bus::Channel::kOdometry) != missing.end();
  if (no_wheels && can_read_scans(config.mode)) {
    text += " (pose.motion: scans estimates the motion from the scans instead)";
  }
  if (!state.empty()) text += "; the pose estimation reports: " + state;
  // With all inputs there, what the estimation reports also says what to do.
  if (channels.empty() && !state.empty()) return text;
  if (channels.empty()) text += ": it has the inputs, but no pose could be computed from them";
  return text +
         "; list the channels of the log with `orchard log info` and set pose.mode accordingly";
}

using bus::Channel;
using bus::ReplayReport;

io::LogPaths logs_of(const MapOptions& options) { return {options.log_paths}; }

std::int64_t num_in(const ReplayReport& report, Channel channel) {
  return report.num_in[static_cast<std::size_t>(channel)];
}
std::int64_t num_out(const ReplayReport& report, Channel channel) {
  return report.num_out[static_cast<std::size_t>(channel)];
}

/// Throws for an empty map, with the inputs that the log lacks: it must not pass for a result.
void require_usable(const MapOptions& options, const pose::PoseConfig& config,
                    const bus::Node& pose_node, const ReplayReport& report) {
  if (num_in(report, Channel::kScan) == 0) {
    throw io::FileError(
        logs_of(options).text() + " has no valid " + std::string(bus::info(Channel::kScan).name) +
        " message; a map needs the scans of the laser (`orchard log info` lists the channels)");
  }
  if (num_out(report, Channel::kPose) == 0) {
    std::vector<Channel> missing;
    for (const Channel channel : pose_node.inputs()) {
      const bool is_needed =
          pose_node.need_of(channel) == bus::InputNeed::kRequired || channel == Channel::kPoseFix;
      if (is_needed && num_in(report, channel) + num_out(report, channel) == 0) {
        missing.push_back(channel);
      }
    }
    throw io::FileError(logs_of(options).text() + " " +
                        no_pose_text(config, missing, pose_node.warning()));
  }
}

/// Prefix of the pose node's statistics in the counts.
const std::string kPoseAccount = "pose_";

std::uint64_t num_lost_bytes(const ReplayReport& report) {
  return std::accumulate(report.gaps.begin(), report.gaps.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const io::LogGap& gap) { return sum + gap.size; });
}

std::vector<std::pair<std::string, std::int64_t>> counts_of(const ReplayReport& report,
                                                            MapPipeline& pipeline) {
  std::vector<std::pair<std::string, std::int64_t>> counts{
      {"events", report.num_events},
      {"unknown_channel", report.num_unknown_channel},
      {"damaged_places", static_cast<std::int64_t>(report.gaps.size())},
      {"damaged_bytes", static_cast<std::int64_t>(num_lost_bytes(report))}};
  const std::vector<bus::Node*> nodes = pipeline.nodes();
  const auto traffic = bus::named_counts(report, {nodes.begin(), nodes.end()});
  counts.insert(counts.end(), traffic.begin(), traffic.end());
  for (const auto& [name, value] : pipeline.pose->statistics()) {
    counts.emplace_back(kPoseAccount + name, value);
  }
  return counts;
}

void print_summary(const MapOptions& options, const ReplayReport& report,
                   const io::MapFolderContent& content, const std::optional<EarlierIdentity>& kept,
                   const std::string& corrections) {
  const mapping::KindCounts kinds(content.landmarks);
  std::printf("%zu landmarks: %s\n", content.landmarks.size(), kinds.text().c_str());
  std::printf("from %" PRId64 " scans and %" PRId64 " images over %.1f s\n",
              num_in(report, Channel::kScan), num_in(report, Channel::kImage),
              1e-6 * static_cast<double>(report.last_utime - report.first_utime));
  std::string losses;
  for (const auto& [name, value] : content.summary.counts) {
    // Not losses: channels of other programs, LCM's own channels, and ids kept from an earlier map.
    const bool is_loss = name != "events" && name != "unknown_channel" &&
                         name.rfind("in_", 0) != 0 && name.rfind(kPoseAccount, 0) != 0 &&
                         name.rfind("out_", 0) != 0 && name.rfind(kCorrectionCount, 0) != 0 &&
                         name.find("_ids") == std::string::npos;
    if (is_loss && value > 0) {
      losses += (losses.empty() ? "" : ", ") + name + " " + std::to_string(value);
    }
  }
  std::printf("losses: %s\n", losses.empty() ? "none" : losses.c_str());
  std::string statistics;
  for (const auto& [name, value] : content.summary.counts) {
    if (name.rfind(kPoseAccount, 0) != 0) continue;
    statistics += (statistics.empty() ? "" : ", ") + name.substr(kPoseAccount.size()) + " " +
                  std::to_string(value);
  }
  if (!statistics.empty()) std::printf("pose: %s\n", statistics.c_str());
  if (kept) {
    std::printf("ids of %s: %d kept, %d gone, %d new\n", options.previous_path.c_str(),
                kept->numbers.num_found, kept->numbers.num_gone, kept->numbers.num_new);
  }
  if (!corrections.empty()) {
    std::printf("corrections by hand: %s (`orchard edit list %s`)\n", corrections.c_str(),
                options.out_folder.c_str());
  }
  std::printf(
      "written to %s: map.csv (table), map.gpkg (QGIS), map.svg, map.png, map.pdf (pictures),\n"
      "  map.html (for a browser), trajectory.csv, trajectory.tum (evo), graph.json (aisles, for "
      "planners), summary.json%s%s\n",
      options.out_folder.c_str(), content.photographs.empty() ? "" : ", album (photographs)",
      options.no_derived ? "" : ", derived.lcm (all intermediate messages)");
}

/// What the drive contradicts of the rig: first where the sensors are, which may be the cause of
/// what the pictures contradict.
std::vector<Finding> findings_of(const MapPipeline& pipeline) {
  std::vector<Finding> findings = pipeline.pose->findings();
  for (Finding& finding : pipeline.detector.findings()) findings.push_back(std::move(finding));
  return findings;
}

/// Tells the worst findings: a wrong rig is the cause of much else, and so comes first.
void tell_findings(const std::vector<Finding>& findings) {
  const std::size_t num_told = std::min<std::size_t>(findings.size(), 3);
  for (std::size_t i = 0; i < num_told; ++i) {
    std::fprintf(stderr, "orchard map: the map is doubtful: %s\n", findings[i].text.c_str());
  }
  if (num_told < findings.size()) {
    std::fprintf(stderr, "orchard map: %zu more such findings in summary.json, section quality\n",
                 findings.size() - num_told);
  }
}

/// The first valid scan at or after a time.
std::optional<laser::Scan> scan_at(const io::LogPaths& logs, std::int64_t utime) {
  io::LogSeries reader(logs);
  while (const auto event = reader.next()) {
    if (event->channel != bus::info(Channel::kScan).name) continue;
    auto scan = bus::decode_as<laser::Scan>(Channel::kScan, event->data);
    if (scan && !scan->ranges_m.empty() && scan->utime >= utime) return scan;
  }
  return std::nullopt;
}

/// Draws the scan in the middle of a doubtful drive: what is wrong with a rig is often seen there.
void write_doubtful_scan(const io::Config& config, const io::LogPaths& logs,
                         const ReplayReport& report, const std::string& path) {
  const std::int64_t middle = report.first_utime + (report.last_utime - report.first_utime) / 2;
  const std::optional<laser::Scan> scan = scan_at(logs, middle);
  if (!scan) return;
  const double at_s = 1e-6 * static_cast<double>(scan->utime - report.first_utime);
  io::write_file_atomically(
      path,
      io::scan_figure(*scan, config.laser, config.detector.segmentation, config.detector.width,
                      fmt::format("{}: the scan at {:.1f} s, from above", logs.text(), at_s),
                      io::FigureFormat::kPng));
  std::fprintf(stderr, "orchard map: what the scanner sees is drawn in %s\n", path.c_str());
}

/// The laser's field of view from the rig and the log's first scan, for later comparisons.
mapping::SensorView sensor_view(const io::Config& config, const io::LogPaths& logs) {
  mapping::SensorView view;
  view.reach_m =
      std::min(config.detector.segmentation.range_max_m, config.mapper.observation_range_max_m);
  view.min_observations = config.mapper.min_observations;
  view.mount_x_m = config.laser.mount_x_m;
  view.mount_y_m = config.laser.mount_y_m;
  view.mount_yaw_rad = config.laser.mount_yaw_rad;
  if (const auto scan = scan_at(logs, std::numeric_limits<std::int64_t>::min())) {
    const double end_rad = scan->bearing_rad(static_cast<double>(scan->ranges_m.size()) - 1.0);
    view.bearing_min_rad = std::min(scan->bearing_min_rad, end_rad);
    view.bearing_max_rad = std::max(scan->bearing_min_rad, end_rad);
  }
  return view;
}

}  // namespace

namespace {

/// Whether a log holds no CONFIG at all; one that is damaged is no reason to learn another.
bool has_no_rig(const io::LogPaths& logs) {
  if (!bus::read_logged_rigs(logs).empty()) return false;
  io::LogSeries reader(logs);
  while (const auto event = reader.next()) {
    if (event->channel == bus::info(Channel::kConfig).name) return false;
  }
  return true;
}

/// The rig that was given, that of the log, or what the drive shows of it: then `learnt` is its
/// YAML.
procs::ReplayRig rig_of(const MapOptions& options, std::string& learnt) {
  const io::LogPaths logs = logs_of(options);
  if (!options.config_path.empty() || !has_no_rig(logs)) {
    return procs::choose_rig(logs, options.config_path);
  }
  LearntRig rig = learn_rig("orchard map", logs, "", options.quiet);
  learnt = rig.yaml;
  procs::ReplayRig chosen{std::move(rig.config), "the learnt rig", {}};
  chosen.notes.push_back("no rig is given and " + logs.text() +
                         " has none, so it was learnt from the drive (orchard help learn):");
  for (const std::string& line : rig.seen) chosen.notes.push_back("  " + line);
  for (const std::string& line : rig.asked) chosen.notes.push_back("  not seen: " + line);
  return chosen;
}

}  // namespace

int run_map(const MapOptions& options) {
  std::string learnt;
  const procs::ReplayRig rig = rig_of(options, learnt);
  const io::Config& config = rig.config;
  for (const std::string& note : rig.notes) {
    std::fprintf(stderr, "orchard map: note: %s\n", note.c_str());
  }
  std::optional<io::CorrectedMapFolder> previous;
  if (!options.previous_path.empty()) {
    previous = io::read_corrected_map(options.previous_path);
    require_other_folder(options.out_folder, {options.previous_path});
    require_corrections_of(options.out_folder, *previous);
  }
  io::make_folder(options.out_folder, "choose another folder with --out");
  MapPipeline pipeline(config, options.out_folder);
  InterruptibleWork work("mapping",
                         !options.quiet);  // from here on Ctrl-C removes partly written files
  const std::string derived_path = options.out_folder + "/derived.lcm";
  std::optional<io::LogWriter> derived;
  if (!options.no_derived) derived.emplace(derived_path);
  pipeline.mapper.set_has_readers(derived.has_value());

  ScanTimer timer;
  bus::ReplayOptions replay;
  replay.strict = options.strict;
  replay.num_jobs = options.num_jobs;
  replay.progress = [&](std::uint64_t done, std::uint64_t total) { work.update(done, total); };
  replay.on_derived = [&](Channel channel, std::int64_t utime,
                          const std::vector<std::uint8_t>& data) {
    if (derived) derived->write(utime, bus::info(channel).name, data);
    if (channel == Channel::kDetections) timer.count();
  };
  const ReplayReport report = bus::replay_in_process(logs_of(options), pipeline.nodes(), replay);
  work.finish();
  std::vector<std::string> warnings = report.warnings;
  for (const bus::Node* node : pipeline.nodes()) {
    if (std::string warning = node->warning(); !warning.empty()) {
      warnings.push_back(std::move(warning));
    }
  }
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "orchard map: warning: %s\n", warning.c_str());
  }
  require_usable(options, config.pose, *pipeline.pose, report);
  io::MapSummary summary;
  summary.source = logs_of(options).names();
  summary.config_hash = io::config_hash(config);
  summary.version = ORCHARD_VERSION;
  summary.first_utime = report.first_utime;
  summary.last_utime = report.last_utime;
  summary.counts = counts_of(report, pipeline);
  summary.warnings = std::move(warnings);
  summary.quality = findings_of(pipeline);
  pipeline.pose.reset();
  io::MapFolderContent content = pipeline.mapper.content(summary);
  content.view = sensor_view(config, logs_of(options));
  if (content.landmarks.empty()) {
    content.summary.warnings.push_back(
        "the map is empty: no object was observed at least mapper.min_observations times");
    std::fprintf(stderr, "orchard map: warning: %s\n", content.summary.warnings.back().c_str());
  }
  tell_findings(content.summary.quality);
  std::optional<EarlierIdentity> kept;
  if (previous) {
    kept = transfer_identity(*previous, options.previous_alignment, content);
    content.rows = mapping::numbered_rows(content.landmarks);
    content.graph = pipeline.mapper.ways_of(content.landmarks, content.rows);
  }
  std::string corrections;
  if (kept) {
    corrections = account_corrections("orchard map", kept->corrections, content);
  } else if (const auto earlier = io::read_corrections(options.out_folder).list; !earlier.empty()) {
    // Corrections of an earlier map in this folder: reported only; the map depends on the log
    // alone.
    io::MapFolderContent seen = content;
    corrections = account_corrections("orchard map", earlier, seen);
  }
  io::write_map_folder(options.out_folder, content);
  const std::string scan_path = options.out_folder + "/scan.png";
  std::filesystem::remove(scan_path);
  if (!content.summary.quality.empty()) {
    write_doubtful_scan(config, logs_of(options), report, scan_path);
  }
  const std::string learnt_path = options.out_folder + "/learnt.yaml";
  if (learnt.empty()) {
    std::filesystem::remove(learnt_path);  // an old file would pass for this map's
  } else {
    io::write_file_atomically(learnt_path, learnt);
  }
  if (kept) write_corrections(options.out_folder, kept->corrections);
  if (derived) {
    derived->close();
  } else {
    std::filesystem::remove(derived_path);  // an old file would pass for this map's
  }
  if (!options.quiet) print_summary(options, report, content, kept, corrections);
  if (options.timing) std::fputs(timer.text().c_str(), stdout);
  return bus::kExitOk;
}

}  // namespace orchard::cli
