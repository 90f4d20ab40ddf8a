// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>

#include "bus/process/process.hpp"
#include "bus/replay/replay_index.hpp"
#include "cli/pair_node.hpp"
#include "detection/detect.hpp"
#include "detection/trunk_view.hpp"
#include "io/atomic_file.hpp"
#include "io/figure/overlay_figure.hpp"
#include "io/figure/scan_figure.hpp"
#include "io/file_error.hpp"
#include "log_player/replay_rig.hpp"
#include "text/number_text.hpp"
#include "timing/drive_time.hpp"
#include "vision/decode.hpp"

namespace orchard::cli {
namespace {

/// Values from here on are an absolute utime, not seconds since the start.
constexpr double kAbsoluteFrom = 1e12;
/// Max distances from the requested time: of the pair, and of the messages read.
constexpr double kReach_s = 1.0;
constexpr double kMargin_s = 1.5;

/// Keeps the pair nearest to a time.
class NearestPair : public PairNode {
 public:
  /// Without a camera, a scan is enough.
  NearestPair(const io::Config& config, std::int64_t utime)
      : PairNode({bus::Channel::kScan, bus::Channel::kImage, bus::Channel::kOdometry},
                 {config.detector.pairing_tolerance_s, config.detector.image_wait_s,
                  config.detector.use_odometry, config.camera.delay_s}),
        utime_(utime),
        needs_image_(config.camera.enabled) {}

  const std::optional<detection::ScanImagePair>& pair() const { return nearest_; }

 private:
  void observe(detection::ScanImagePair pair) override {
    if (needs_image_ && !pair.image) return;
    if (distance_us(pair) > static_cast<std::int64_t>(1e6 * kReach_s)) return;
    if (!nearest_ || distance_us(pair) < distance_us(*nearest_)) nearest_ = std::move(pair);
  }
  std::int64_t distance_us(const detection::ScanImagePair& pair) const {
    return std::llabs(pair.scan.utime - utime_);
  }

  std::int64_t utime_;
  bool needs_image_;
  std::optional<detection::ScanImagePair> nearest_;
};

/// The requested utime, limited to the range of the log.
std::int64_t utime_asked(const OverlayOptions& options, const bus::ReplayIndex& index) {
  const std::int64_t first = index.report.first_utime, last = index.report.last_utime;
  const double at_us =
      options.at >= kAbsoluteFrom ? options.at : static_cast<double>(first) + 1e6 * options.at;
  if (!(at_us >= static_cast<double>(first) && at_us <= static_cast<double>(last))) {
    throw io::FileError(options.log_path + " covers 0 s to " +
                        fixed_text(1e-6 * static_cast<double>(last - first), 3) + " s (utime " +
                        std::to_string(first) + " to " + std::to_string(last) +
                        "); give --at within it");
  }
  return std::llround(at_us);
}

/// The time of the scan nearest to another; that time if there is no scan.
std::int64_t nearest_scan(const bus::ReplayIndex& index, std::int64_t utime) {
  std::optional<std::int64_t> nearest;
  for (const auto& entry : index.entries) {
    const std::int64_t at = timing::utime_of(entry.drive_time);
    if (entry.channel != bus::Channel::kScan) continue;
    if (!nearest || std::llabs(at - utime) < std::llabs(*nearest - utime)) nearest = at;
  }
  return nearest.value_or(utime);
}

void require_channel(const OverlayOptions& options, const bus::ReplayIndex& index,
                     bus::Channel channel, const char* what) {
  const auto& entries = index.entries;
  const bool found = std::any_of(entries.begin(), entries.end(),
                                 [&](const auto& entry) { return entry.channel == channel; });
  if (found) return;
  throw io::FileError(options.log_path + " has no valid " + std::string(bus::info(channel).name) +
                      " message; the overlay needs " + what + " (see `orchard log info`)");
}

std::vector<io::OverlayPoint> points_of(const laser::Scan& scan, const detection::Rig& rig,
                                        const detection::ScanToPicture& to_exposure) {
  std::vector<io::OverlayPoint> points;
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (!scan.valid(beam)) continue;
    const double range_m = scan.ranges_m[beam];
    const auto pixel = detection::project_beam(range_m, scan.bearing_rad(static_cast<double>(beam)),
                                               beam, rig, to_exposure);
    if (pixel) points.push_back({pixel->x(), pixel->y(), range_m});
  }
  return points;
}

std::string scan_words(const laser::Scan& scan, std::int64_t first_utime) {
  return "scan " + fixed_text(1e-6 * static_cast<double>(scan.utime - first_utime), 3) +
         " s (utime " + std::to_string(scan.utime) + ")";
}

io::OverlayContent content_of(const OverlayOptions& options, const detection::ScanImagePair& pair,
                              const procs::ReplayRig& replay_rig, std::int64_t first_utime) {
  const io::Config& config = replay_rig.config;
  const detection::Rig rig(config.laser, config.camera, config.detector);
  const vision::Image& image = *pair.image;
  const auto& camera = config.camera.intrinsics;
  if (image.width_px != camera.width_px || image.height_px != camera.height_px) {
    throw io::FileError(options.log_path + " has pictures of " + std::to_string(image.width_px) +
                        "x" + std::to_string(image.height_px) + " px, but " + replay_rig.name +
                        " describes a camera of " + std::to_string(camera.width_px) + "x" +
                        std::to_string(camera.height_px) +
                        "; give the rig of this recording with --config");
  }
  auto picture = vision::decode(image, detection::picture_of(rig));
  if (!picture) {
    throw io::FileError(options.log_path + ": the picture at utime " + std::to_string(image.utime) +
                        " cannot be decoded; give another --at");
  }
  const auto findings = detection::find_by_laser(pair.scan, rig);
  const auto to_exposure = detection::to_picture(findings, image, rig, pair.motion);
  vision::PictureReader reader(image);
  const auto judged = detection::judge_by_camera(findings, &reader, rig, pair.motion);
  const auto edges = vision::edge_map(*picture, config.detector.edges);
  io::OverlayContent content;
  int num_outside = 0;
  content.points = points_of(pair.scan, rig, to_exposure);
  for (const detection::Candidate& candidate : findings.candidates) {
    const auto view = detection::view_of(candidate.segment, rig, to_exposure);
    if (!view) {
      ++num_outside;
      continue;
    }
    const detection::Detection& d = judged.detections.trunks[candidate.index];
    content.candidates.push_back(
        {*view, vision::find_edge(edges, view->left_edge, view->left_x_px, config.detector.edges),
         vision::find_edge(edges, view->right_edge, view->right_x_px, config.detector.edges),
         d.roc_vision > 0.0f, d});
  }
  const std::string exposed = fmt::format(
      "{:+.3f}", 1e-6 * static_cast<double>(image.utime - pair.scan.utime) - config.camera.delay_s);
  content.title = scan_words(pair.scan, first_utime) + ", picture " + exposed + " s" +
                  (to_exposure.motion ? ", moved by odometry" : "") + "; points red near, blue far";
  if (num_outside > 0) content.title += "; " + std::to_string(num_outside) + " more outside";
  content.picture = std::move(*picture);
  return content;
}

}  // namespace

int run_overlay(const OverlayOptions& options) {
  const procs::ReplayRig rig = procs::choose_rig(options.log_path, options.config_path);
  for (const std::string& note : rig.notes) {
    std::fprintf(stderr, "orchard overlay: note: %s\n", note.c_str());
  }
  const io::Config& config = rig.config;
  const io::FigureFormat format = io::figure_format(options.out_path);
  const bus::ReplayIndex index = bus::index_log(options.log_path, {});
  require_channel(options, index, bus::Channel::kScan, "the laser's scans");
  if (config.camera.enabled) require_channel(options, index, bus::Channel::kImage, "pictures");
  const std::int64_t first_utime = index.report.first_utime;
  std::int64_t utime = utime_asked(options, index);
  if (!config.camera.enabled) utime = nearest_scan(index, utime);

  NearestPair node(config, utime);
  bus::ReplayOptions replay;
  const double at_s = 1e-6 * static_cast<double>(utime - first_utime);
  replay.from_s = std::max(0.0, at_s - kMargin_s);
  replay.to_s = at_s + kMargin_s;
  bus::replay_in_process(options.log_path, {&node}, replay);
  if (!node.pair()) {
    throw io::FileError(options.log_path + " has no pair of scan and picture within " +
                        fixed_text(kReach_s, 3) + " s of --at " + fixed_text(at_s, 3) +
                        " s of each other (detector.pairing_tolerance_s)");
  }
  if (!config.camera.enabled) {
    const laser::Scan& scan = node.pair()->scan;
    io::write_file_atomically(
        options.out_path,
        io::scan_figure(scan, config.laser, config.detector.segmentation, config.detector.width,
                        scan_words(scan, first_utime) + ", from above", format));
    std::printf("written to %s: the scan from above, as the rig has no camera\n",
                options.out_path.c_str());
    return bus::kExitOk;
  }
  const io::OverlayContent content = content_of(options, *node.pair(), rig, first_utime);
  io::write_file_atomically(options.out_path, io::overlay_figure(content, format));
  std::printf("written to %s: %zu scan points, %zu candidates\n", options.out_path.c_str(),
              content.points.size(), content.candidates.size());
  return bus::kExitOk;
}

}  // namespace orchard::cli
