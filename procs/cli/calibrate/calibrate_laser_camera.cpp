// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bus/process/process.hpp"
#include "calibration/board/board.hpp"
#include "calibration/extrinsics/laser_camera_calibration.hpp"
#include "calibration/extrinsics/stationary_views.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "cli/pair_node.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

/// Detects a calibration board in a log's scan-image pairs.
class BoardCollector : public PairNode {
 public:
  BoardCollector(const io::Config& config, const calibration::BoardConfig& board)
      : PairNode({bus::Channel::kScan, bus::Channel::kImage},
                 {config.detector.pairing_tolerance_s, config.detector.image_wait_s}),
        intrinsics_(config.camera.intrinsics),
        board_(board) {}

  void handle(const bus::Message& input, const bus::Outbox& send) override {
    if (std::holds_alternative<laser::Scan>(input)) ++num_scans_;
    if (const auto* image = std::get_if<vision::Image>(&input)) {
      ++num_images_;
      if (image->width_px != intrinsics_.width_px || image->height_px != intrinsics_.height_px) {
        ++num_wrong_size_;
        wrong_size_ = std::to_string(image->width_px) + "x" + std::to_string(image->height_px);
        return;
      }
    }
    PairNode::handle(input, send);
  }

  /// The pairs with the board in their picture, in order of time.
  const std::vector<calibration::BoardPair>& pairs() const { return pairs_; }
  int num_scans() const { return num_scans_; }
  int num_images() const { return num_images_; }
  int num_pairs() const { return num_pairs_; }
  /// Number of unreadable pictures in pairs.
  int num_unreadable() const { return num_unreadable_; }
  /// Number of pictures with another size than configured.
  int num_wrong_size() const { return num_wrong_size_; }
  /// Size of the last of them, "640x480"; empty: none.
  const std::string& wrong_size() const { return wrong_size_; }

 private:
  void observe(detection::ScanImagePair pair) override {
    if (!pair.image) return;
    ++num_pairs_;
    const auto grey = calibration::grey_of(*pair.image);
    if (!grey) {
      ++num_unreadable_;
      return;
    }
    if (auto board = calibration::find_board(*grey, board_)) {
      pairs_.push_back({std::move(pair.scan), std::move(*board)});
    }
  }

  geometry::CameraIntrinsics intrinsics_;
  calibration::BoardConfig board_;
  std::vector<calibration::BoardPair> pairs_;
  int num_scans_ = 0;
  int num_images_ = 0;
  int num_pairs_ = 0;
  int num_unreadable_ = 0;
  int num_wrong_size_ = 0;
  std::string wrong_size_;
};

using calibration::LaserCameraView;
using calibration::RigidExtrinsics;

constexpr double kDeg = 3.14159265358979323846 / 180.0;
/// Max motion of the corners of a still board between two pictures, as a fraction of the image
/// width.
constexpr double kStillShift = 0.8 / 320.0;

/// The usable views of a log; prints the reasons for rejecting others.
std::vector<calibration::StationaryView> read_views(const CalibrateLaserCameraOptions& options,
                                                    const io::Config& config) {
  BoardCollector collector(config, options.board);
  std::set<std::string> said;
  replay_log("orchard calibrate laser-camera", options.log_path, {&collector}, options.quiet, said);
  const std::string& log = options.log_path;
  const auto& lens = config.camera.intrinsics;
  if (collector.num_wrong_size() > 0 && collector.num_wrong_size() < collector.num_images()) {
    throw io::FileError(
        fmt::format("{}: the pictures differ in size: {} of {} are not {}x{} (as in {}) but, for "
                    "example, {}; record again at one resolution",
                    log, collector.num_wrong_size(), collector.num_images(), lens.width_px,
                    lens.height_px, options.config_path, collector.wrong_size()));
  }
  if (collector.num_wrong_size() > 0) {
    throw io::FileError(fmt::format(
        "{}: the pictures are {}, but the camera of {} has {}x{}; give the configuration of this "
        "camera",
        log, collector.wrong_size(), options.config_path, lens.width_px, lens.height_px));
  }
  if (collector.num_scans() == 0)
    throw io::FileError(log + ": this log has no valid SCAN; record the laser, too");
  if (collector.num_images() == 0)
    throw io::FileError(log + ": this log has no valid IMAGE; record the camera, too");
  if (collector.num_pairs() == 0) {
    throw io::FileError(
        fmt::format("{}: no picture is within {:.3f} s of a scan (detector.pairing_tolerance_s); "
                    "check that laser and camera are stamped by the same clock",
                    log, config.detector.pairing_tolerance_s));
  }
  if (collector.num_unreadable() == collector.num_pairs()) {
    throw io::FileError(fmt::format(
        "{}: none of its {} pictures can be decoded; record JPEG, or raw pixels of the size "
        "that the message states",
        log, collector.num_pairs()));
  }
  if (collector.pairs().empty()) {
    throw io::FileError(fmt::format(
        "{}: the board was not found in any picture: no chessboard of {}x{} inner corners "
        "in {} pictures; show the whole board in good light, and check --columns and --rows",
        log, options.board.columns, options.board.rows, collector.num_pairs()));
  }
  const double shift_max_px = kStillShift * config.camera.intrinsics.width_px;
  auto views = calibration::stationary_views(collector.pairs(), shift_max_px);
  constexpr std::size_t kEnough = 6;
  if (views.size() < kEnough && collector.pairs().size() > 2 * views.size() + kEnough) {
    std::fprintf(stderr,
                 "orchard calibrate laser-camera: warning: the board was hardly ever held still "
                 "for two pictures, so each picture counts as a view; motion between scan and "
                 "picture adds errors\n");
    views = calibration::single_views(collector.pairs());
  }
  if (!options.quiet) {
    std::printf("%d scans with a picture, %zu of them with the board; %zu views of a still board\n",
                collector.num_pairs(), collector.pairs().size(), views.size());
  }
  return calibration::spread_subset(views, kMaxViews);
}

const char* status_text(LaserCameraView::ViewStatus status) {
  switch (status) {
    case LaserCameraView::ViewStatus::kUsed:
      return "used";
    case LaserCameraView::ViewStatus::kNoLine:
      return "no line as long as the board in the scan";
    case LaserCameraView::ViewStatus::kNotSeen:
      return "no scan line on the board";
    default:
      return "OUTLIER, not used";
  }
}

void print_views(const calibration::LaserCameraCalibration& result,
                 const std::vector<calibration::ExtrinsicsView>& views,
                 const std::vector<std::int64_t>& utimes) {
  std::printf("%-5s %-17s %5s %10s %9s %8s %8s %7s\n", "view", "utime", "scans", "distance m",
              "corner px", "mean mm", "rms mm", "sigmas");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const LaserCameraView& view = result.views[i];
    std::printf("%-5zu %-17lld %5d %10.3f %9.3f ", i + 1, static_cast<long long>(utimes[i]),
                views[i].num_scans, views[i].board.distance_m(), views[i].board.rms_px);
    if (view.status == LaserCameraView::ViewStatus::kUsed ||
        view.status == LaserCameraView::ViewStatus::kOutlier) {
      std::printf("%8.1f %8.1f %7.1f  ", 1e3 * view.mean_m, 1e3 * view.rms_m, view.disagreement);
    } else {
      std::printf("%8s %8s %7s  ", "-", "-", "-");
    }
    std::printf("%s\n", status_text(view.status));
  }
  std::printf(
      "(corner px: RMS distance of the corners from a flat board; mean, rms: distance of the scan "
      "points from the board; sigmas: disagreement with the other views)\n");
}

bool has_outlier(const calibration::LaserCameraCalibration& result) {
  return std::any_of(result.views.begin(), result.views.end(), [](const LaserCameraView& view) {
    return view.status == LaserCameraView::ViewStatus::kOutlier;
  });
}

void print_result(const calibration::LaserCameraCalibration& result) {
  const auto sd = [&](int i) { return std::sqrt(result.covariance(i, i)); };
  std::printf("%d of %zu views used; their scan points are %.1f mm (RMS) from the boards\n",
              result.num_used, result.views.size(), 1e3 * result.rms_m);
  std::printf("delta_m %s, standard deviations %.1f, %.1f, %.1f mm (camera axes x, y, z)\n",
              io::config_numbers(result.extrinsics.delta_m, 5).c_str(), 1e3 * sd(0), 1e3 * sd(1),
              1e3 * sd(2));
  std::printf(
      "phi_rad %s, standard deviations %.2f, %.2f, %.2f deg (about the camera axes x, y, z)\n",
      io::config_numbers(result.extrinsics.phi_rad, 5).c_str(), sd(3) / kDeg, sd(4) / kDeg,
      sd(5) / kDeg);
  std::printf("95 %% confidence interval: +- %.2f standard deviations\n", result.interval95_factor);
}

RigidExtrinsics mount_of(const geometry::LaserCameraExtrinsics& extrinsics) {
  const geometry::LaserToCamera T(extrinsics);
  return {T.rotation(), T.translation_m()};
}

void write(const CalibrateLaserCameraOptions& options,
           const geometry::LaserCameraExtrinsics& extrinsics, const std::string& note) {
  write_rig(options.config_path, options.out_path,
            {{"camera.delta_m", io::config_numbers(extrinsics.delta_m, 5)},
             {"camera.phi_rad", io::config_numbers(extrinsics.phi_rad, 5)}},
            "orchard calibrate laser-camera", note, options.quiet);
}

}  // namespace

int run_calibrate_laser_camera(const CalibrateLaserCameraOptions& options) {
  const io::Config config = io::load_config(options.config_path);
  if (!config.camera.enabled) {
    throw io::FileError(options.config_path +
                        ": camera.enabled is false; set it to true to calibrate a camera");
  }
  const CalibrateLaserCameraOptions& o = options;
  if (const auto problem = calibration::problem_with(o.board)) throw io::FileError(*problem);

  // The outer size, measured or guessed; a guess only rules out objects that cannot be the board.
  const bool measured = o.board_width_m > 0.0 && o.board_height_m > 0.0;
  calibration::BoardOutline outline = calibration::outline_of(o.board);
  if (measured) {
    const double x_m = 0.5 * (outline.x_min_m + outline.x_max_m);
    const double y_m = 0.5 * (outline.y_min_m + outline.y_max_m);
    outline = {x_m - 0.5 * o.board_width_m, y_m - 0.5 * o.board_height_m,
               x_m + 0.5 * o.board_width_m, y_m + 0.5 * o.board_height_m};
  }
  const auto still = read_views(o, config);
  std::vector<calibration::BoardView> boards;
  for (const auto& view : still) boards.push_back(view.board);
  const geometry::CameraModel camera(config.camera.intrinsics);
  const auto poses = calibration::estimate_board_poses(boards, camera);
  const auto search = calibration::line_search(outline, config.laser);
  std::vector<calibration::ExtrinsicsView> views;
  std::vector<std::int64_t> utimes;
  for (std::size_t i = 0; i < still.size(); ++i) {
    if (!poses[i] || poses[i]->ambiguous) continue;
    views.push_back(
        {*poses[i], calibration::find_board_lines(still[i].scan, search), still[i].num_pairs});
    utimes.push_back(still[i].scan.utime);
  }
  calibration::LaserCameraOptions rules = calibration::laser_camera_options(config.laser);
  rules.use_edges = measured;
  const auto result = calibration::calibrate_laser_camera(views, outline, rules);
  if (!result.refusal.empty()) {
    if (!o.quiet && has_outlier(result)) print_views(result, views, utimes);
    if (result.board_scale > 0.0) {
      throw io::FileError(fmt::format(
          "{}: {}; --square-m was {:.1f} mm, but {:.1f} mm would fit. Measure ten squares together "
          "with a ruler; if --square-m is right, camera.fc_px is wrong by that factor",
          o.log_path, result.refusal, 1e3 * o.board.square_m,
          1e3 * o.board.square_m * result.board_scale));
    }
    throw io::FileError(o.log_path + ": " + result.refusal);
  }
  const std::string contradiction =
      calibration::extrinsics_contradiction(result.mount, mount_of(config.camera.extrinsics));
  if (!contradiction.empty() && !o.any_mount) {
    throw io::FileError(o.log_path + ": " + contradiction +
                        ". If the sensors are really mounted this way, use --any-mount or put "
                        "approximate camera.phi_rad and camera.delta_m into " +
                        o.config_path);
  }
  if (!contradiction.empty()) {
    std::fprintf(stderr, "orchard calibrate laser-camera: warning: %s\n", contradiction.c_str());
  }
  if (!o.quiet) {
    print_views(result, views, utimes);
    print_result(result);
    if (!measured) {
      std::printf(
          "with the outer size of the board (--board-width-m, --board-height-m) the result would "
          "be more accurate: the ends of the scan lines are used, too\n");
    }
  }
  const auto sd = [&](int i) { return std::sqrt(result.covariance(i, i)); };
  write(o, result.extrinsics,
        fmt::format("{} views in {}, {:.1f} mm RMS; sd of delta {:.1f} {:.1f} {:.1f} mm, of the "
                    "rotation {:.2f} "
                    "{:.2f} {:.2f} deg",
                    result.num_used, std::filesystem::path(o.log_path).filename().string(),
                    1e3 * result.rms_m, 1e3 * sd(0), 1e3 * sd(1), 1e3 * sd(2), sd(3) / kDeg,
                    sd(4) / kDeg, sd(5) / kDeg));
  return bus::kExitOk;
}

}  // namespace orchard::cli
