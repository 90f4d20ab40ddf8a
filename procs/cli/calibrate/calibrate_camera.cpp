// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate_camera.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "bus/process/process.hpp"
#include "calibration/board/camera_acceptance.hpp"
#include "calibration/board/view_selection.hpp"
#include "cli/calibrate/board_views.hpp"
#include "cli/rig/rig_camera.hpp"
#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/config/camera_import.hpp"
#include "io/figure/coverage_figure.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

using calibration::CameraCalibration;

std::string pm(double value, double sd, int digits) {
  return fixed_text(value, digits) + " +- " + fixed_text(sd, digits);
}

void print_camera(const geometry::CameraIntrinsics& camera) {
  for (const io::ConfigValue& value : rig_values_of(camera)) {
    std::printf("  %s: %s\n", value.key.c_str(), value.value.c_str());
  }
}

void print_coverage(const CameraCalibration& calibration) {
  const calibration::CameraAcceptanceLimits rules;
  const auto coverage = calibration::coverage_of(calibration, rules.grid_columns, rules.grid_rows);
  std::printf("corners found in each part of the picture (%.0f %% covered):\n",
              100.0 * coverage.fraction());
  for (int row = 0; row < coverage.rows; ++row) {
    for (int column = 0; column < coverage.columns; ++column) {
      std::printf("%6d",
                  coverage.corners[static_cast<std::size_t>(row * coverage.columns + column)]);
    }
    std::printf("\n");
  }
}

void print_calibration(const CameraCalibration& calibration) {
  std::printf("%-40s %8s %8s %9s %10s\n", "view", "corners", "rms px", "tilt deg", "distance m");
  double least_m = 1e9, most_m = 0.0, tilt_rad = 0.0;
  for (const calibration::ViewFigures& view : calibration.views) {
    // Show the end of a long path: it distinguishes the views.
    const std::string name =
        view.name.size() <= 40 ? view.name : ".." + view.name.substr(view.name.size() - 38);
    std::printf("%-40s %8d %8.3f %9.1f %10.3f%s\n", name.c_str(), view.num_corners, view.rms_px,
                view.tilt_rad * 180.0 / geometry::kPi, view.distance_m,
                view.used ? "" : "  not used: disagrees with the other views");
    if (!view.used) continue;
    least_m = std::min(least_m, view.distance_m);
    most_m = std::max(most_m, view.distance_m);
    tilt_rad = std::max(tilt_rad, view.tilt_rad);
  }
  std::printf(
      "%d views, %d corners; tilted by up to %.0f degrees, at distances of %.2f to %.2f m\n",
      calibration.num_views, calibration.num_corners, tilt_rad * 180.0 / geometry::kPi, least_m,
      most_m);
  print_coverage(calibration);
  const geometry::CameraIntrinsics& camera = calibration.intrinsics;
  std::printf("focal length     %s, %s px\n",
              pm(camera.fc_px[0], calibration.fc_sd_px[0], 2).c_str(),
              pm(camera.fc_px[1], calibration.fc_sd_px[1], 2).c_str());
  std::printf("principal point  %s, %s px\n",
              pm(camera.cc_px[0], calibration.cc_sd_px[0], 2).c_str(),
              pm(camera.cc_px[1], calibration.cc_sd_px[1], 2).c_str());
  constexpr std::array<const char*, 5> kNames{"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    std::printf("%s               %s\n", kNames[i],
                pm(camera.kc[i], calibration.kc_sd[i], 5).c_str());
  }
  std::printf("(+- one standard deviation); reprojection error %.3f px\n", calibration.rms_px);
}

void warn_of_pictures_without_board(const BoardViews& found) {
  if (found.without_board.empty()) return;
  constexpr std::size_t kNamed = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, found.without_board.size()); ++i) {
    names += (i > 0 ? ", " : "") + found.without_board[i];
  }
  if (found.without_board.size() > kNamed) names += ", ...";
  std::fprintf(
      stderr, "orchard calibrate camera: note: no board found in %zu of %zu pictures: %s\n",
      found.without_board.size(), found.without_board.size() + found.views.size(), names.c_str());
}

std::string board_text(const calibration::BoardConfig& board) {
  const bool chess = board.kind == calibration::BoardConfig::kChessboard;
  return (chess ? "chessboard " : "ChArUco board ") + std::to_string(board.columns) + " x " +
         std::to_string(board.rows) + " of " + fixed_text(1e3 * board.square_m, 1) + " mm";
}

std::string note_of(const CameraCalibration& calibration, const std::string& source,
                    const calibration::BoardConfig& board, std::size_t num_reasons) {
  std::string note = std::to_string(calibration.num_views) + " views in " + source + ", " +
                     board_text(board) + ", rms " + fixed_text(calibration.rms_px, 3) +
                     " px; sd fc " + fixed_text(calibration.fc_sd_px[0], 2) + ", " +
                     fixed_text(calibration.fc_sd_px[1], 2) + ", cc " +
                     fixed_text(calibration.cc_sd_px[0], 2) + ", " +
                     fixed_text(calibration.cc_sd_px[1], 2) + " px";
  if (num_reasons > 0) {
    note += "; FORCED despite " + std::to_string(num_reasons) + " failed checks";
  }
  return note;
}

int import_camera(const CalibrateCameraOptions& options) {
  if (!options.paths.empty()) {
    throw io::FileError(options.paths.front() + ": give either pictures or --import, not both");
  }
  const io::ImportedCamera imported = io::read_camera_file(options.import_path);
  const RigTarget target = rig_target(options.config_path, options.out_path);
  check_size(target, imported.intrinsics, options.import_path, options.force);
  if (!options.quiet) {
    std::printf("%s: %s\n", options.import_path.c_str(), imported.kind.c_str());
    if (imported.fc_sd_px && imported.cc_sd_px) {
      std::printf("standard deviations stated in it: fc %.2f, %.2f px, cc %.2f, %.2f px\n",
                  (*imported.fc_sd_px)[0], (*imported.fc_sd_px)[1], (*imported.cc_sd_px)[0],
                  (*imported.cc_sd_px)[1]);
    }
    print_camera(imported.intrinsics);
  }
  std::string note = "imported from " + imported.kind + " " +
                     std::filesystem::path(options.import_path).filename().string();
  if (imported.fc_sd_px) note += ", sd fc " + fixed_text((*imported.fc_sd_px)[0], 2) + " px";
  write_rig_camera(target, imported.intrinsics, note, options.quiet);
  return bus::kExitOk;
}

/// Selects the views to use: the most different ones if there are many.
std::vector<calibration::NamedView> selected_views(const BoardViews& found, int max_views,
                                                   bool quiet) {
  std::vector<calibration::NamedView> views;
  for (const std::size_t i : calibration::select_spread(
           found.views, found.width_px, found.height_px, static_cast<std::size_t>(max_views))) {
    views.push_back(found.views[i]);
  }
  if (!quiet && views.size() < found.views.size()) {
    std::printf("using %zu of %zu views, the most different ones (--max-views)\n", views.size(),
                found.views.size());
  }
  return views;
}

}  // namespace

int run_calibrate_camera(const CalibrateCameraOptions& options) {
  if (!options.import_path.empty()) return import_camera(options);
  if (options.paths.empty()) {
    throw io::FileError("no input: give pictures, a folder of them, a log, or --import FILE");
  }
  calibration::BoardConfig board = options.board;
  board.kind = options.board_kind == "charuco" ? calibration::BoardConfig::kCharuco
                                               : calibration::BoardConfig::kChessboard;
  if (const auto problem = calibration::problem_with(board)) throw io::FileError(*problem);
  const RigTarget target = rig_target(options.config_path, options.out_path);
  const bool draws = !options.coverage_path.empty();
  const auto format = draws ? io::figure_format(options.coverage_path) : io::FigureFormat::kPng;

  const BoardViews found = find_board_views(options.paths, board, options.quiet);
  geometry::CameraIntrinsics pictures;
  pictures.width_px = found.width_px;
  pictures.height_px = found.height_px;
  check_size(target, pictures, "the pictures (" + found.views.front().name + ")", options.force);
  warn_of_pictures_without_board(found);

  calibration::CameraCalibrationOptions how;
  how.estimate_k3 = options.estimate_k3;
  CameraCalibration calibration;
  try {
    calibration =
        calibration::calibrate_camera(selected_views(found, options.max_views, options.quiet),
                                      found.width_px, found.height_px, how);
  } catch (const std::runtime_error& error) {
    throw io::FileError(found.source + ": " + error.what());
  }
  if (!options.quiet) print_calibration(calibration);
  if (draws) {
    io::write_file_atomically(options.coverage_path, io::coverage_figure(calibration, format));
    if (!options.quiet) std::printf("corners drawn to %s\n", options.coverage_path.c_str());
  }
  const std::vector<std::string> reasons = calibration::rejection_reasons(calibration);
  for (const std::string& reason : reasons) {
    std::fprintf(stderr, "orchard calibrate camera: %s\n", reason.c_str());
  }
  if (!reasons.empty() && !options.force) {
    std::fprintf(stderr,
                 "orchard calibrate camera: the result failed the checks above and was not "
                 "written; add the views that are missing, or write it anyway with --force\n");
    return bus::kExitInput;
  }
  if (!options.quiet && reasons.empty()) std::printf("all checks passed\n");
  write_rig_camera(target, calibration.intrinsics,
                   note_of(calibration, found.source, board, reasons.size()), options.quiet);
  if (!options.quiet && target.out_path.empty()) print_camera(calibration.intrinsics);
  return bus::kExitOk;
}

}  // namespace orchard::cli
