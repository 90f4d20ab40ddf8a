// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages/decode_as.hpp"
#include "bus/process/process.hpp"
#include "calibration/board/camera_calibration.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "io/atomic_file.hpp"
#include "io/config/camera_import.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"
#include "io/progress_bar.hpp"
#include "io/recording/picture_file.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

/// Detections of the board in the given pictures.
struct BoardViews {
  std::vector<calibration::NamedView> views;
  std::vector<std::string> without_board;  ///< pictures without a detection
  std::string source;                      ///< for the user: "23 pictures", "drive.lcm"
  int width_px = 0;
  int height_px = 0;
};

namespace fs = std::filesystem;

/// Max number of pictures of a log to search: a board moves slowly, and each picture takes about 20
/// ms.
constexpr std::size_t kMaxSearched = 400;

/// Searches pictures one by one and requires them to have equal size.
class Search {
 public:
  Search(const calibration::BoardConfig& board, BoardViews& found) : board_(board), found_(found) {}

  void add(const std::string& name, const calibration::GreyPicture& picture) {
    if (first_name_.empty()) {
      first_name_ = name;
      found_.width_px = picture.width_px;
      found_.height_px = picture.height_px;
    } else if (picture.width_px != found_.width_px || picture.height_px != found_.height_px) {
      throw io::FileError(fmt::format(
          "{}: its size is {} x {} pixels, but that of {} is {} x {}; give pictures of one camera "
          "and one size",
          name, picture.width_px, picture.height_px, first_name_, found_.width_px,
          found_.height_px));
    }
    if (auto view = calibration::find_board(picture, board_)) {
      found_.views.push_back({name, std::move(*view)});
    } else {
      found_.without_board.push_back(name);
    }
  }

 private:
  const calibration::BoardConfig& board_;
  BoardViews& found_;
  std::string first_name_;
};

std::vector<std::string> picture_files(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (const auto& entry : fs::directory_iterator(path)) {
      if (entry.is_regular_file() && io::has_picture_name(entry.path().string())) {
        inside.push_back(entry.path().string());
      }
    }
    if (inside.empty()) {
      throw io::FileError(path +
                          ": this folder has no pictures (.jpg, .jpeg, .png); give the folder with "
                          "the pictures of the board");
    }
    std::sort(inside.begin(), inside.end());
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

void search_files(const std::vector<std::string>& files, Search& search, bool quiet) {
  io::ProgressBar bar("looking for the board", !quiet);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto picture = calibration::grey_of(io::read_picture_file(files[i]));
    if (!picture) {
      throw io::FileError(files[i] + ": this picture is damaged; remove or replace it");
    }
    search.add(files[i], *picture);
    bar.update(i + 1, files.size());
  }
}

void search_log(const std::string& path, Search& search, bool quiet) {
  const auto image_channel = bus::info(bus::Channel::kImage).name;
  io::LogReader reader(path);
  std::vector<std::uint64_t> offsets;
  io::ProgressBar reading("reading " + path, !quiet);
  while (const auto event = reader.next()) {
    if (event->channel == image_channel) offsets.push_back(event->offset);
    reading.update(reader.position(), reader.file_size());
  }
  reading.finish();
  if (offsets.empty()) {
    throw io::FileError(path + ": " +
                        (reader.num_events() == 0 ? "this file is neither an LCM log nor a picture"
                                                  : "this log has no IMAGE") +
                        "; give pictures (.jpg, .png), a folder of them, or a log with " +
                        std::string(image_channel));
  }
  io::ProgressBar bar("looking for the board", !quiet);
  const std::size_t num = std::min(offsets.size(), kMaxSearched);
  std::int64_t first_utime = 0;
  int num_refused = 0;
  for (std::size_t i = 0; i < num; ++i) {
    const io::LogEvent event = reader.read_at(offsets[i * offsets.size() / num]);
    const auto image = bus::decode_as<vision::Image>(bus::Channel::kImage, event.data);
    const auto picture =
        image ? calibration::grey_of(*image) : std::optional<calibration::GreyPicture>();
    bar.update(i + 1, num);
    if (!picture) {
      ++num_refused;
      continue;
    }
    if (first_utime == 0) first_utime = image->utime;
    const double at_s = 1e-6 * static_cast<double>(image->utime - first_utime);
    search.add(path + " at " + fixed_text(at_s, 2) + " s", *picture);
  }
  bar.finish();
  if (num_refused > 0) {
    std::fprintf(stderr, "orchard calibrate: warning: %s: %d of %zu pictures are damaged\n",
                 path.c_str(), num_refused, num);
  }
}

/// Detects the board in picture files, in folders of them, or in the IMAGE messages of one log (at
/// most 400 of them, evenly spaced over the log). Throws io::FileError when a file cannot be read,
/// the pictures differ in size, there are none, or none shows the board.
BoardViews find_board_views(const std::vector<std::string>& paths,
                            const calibration::BoardConfig& board, bool quiet) {
  BoardViews found;
  Search search(board, found);
  const bool is_log =
      paths.size() == 1 && fs::is_regular_file(paths[0]) && !io::has_picture_name(paths[0]);
  if (is_log) {
    search_log(paths[0], search, quiet);
    found.source = fs::path(paths[0]).filename().string();
  } else {
    const std::vector<std::string> files = picture_files(paths);
    search_files(files, search, quiet);
    found.source = std::to_string(files.size()) + " pictures";
  }
  if (found.views.empty()) {
    throw io::FileError(fmt::format(
        "no board was found in any of the {} pictures (the first is {}); show a chessboard of {} x "
        "{} "
        "inner corners (--columns, --rows) entirely in view, sharp and with a white margin",
        found.without_board.size(), found.without_board.front(), board.columns, board.rows));
  }
  return found;
}

/// Input and output files for writing a camera into a rig's YAML.
struct RigTarget {
  std::string config_path;  ///< rig to start from; empty: none
  std::string out_path;     ///< empty: do not write
};

/// Resolves the options: --out is the file to write (default: --config, in place), --config the one
/// to start from (default: --out when it exists). Throws io::ConfigError when that is not a rig's
/// YAML.
RigTarget rig_target(const std::string& config_path, const std::string& out_path) {
  RigTarget target{config_path, out_path.empty() ? config_path : out_path};
  if (target.config_path.empty() && std::filesystem::exists(target.out_path)) {
    target.config_path = target.out_path;
  }
  if (!target.config_path.empty()) io::load_config(target.config_path);
  return target;
}

/// Throws io::FileError when the picture size of the rig to start from differs from the camera's,
/// unless `force`. `what` names the camera in the message.
void check_size(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                const std::string& what, bool force) {
  if (force || target.config_path.empty()) return;
  const io::Config config = io::load_config(target.config_path);
  const geometry::CameraIntrinsics& rig = config.camera.intrinsics;
  if (rig.width_px == camera.width_px && rig.height_px == camera.height_px) return;
  throw io::FileError(fmt::format(
      "{}: camera.width_px x height_px is {} x {}, but the size of {} is {} x {}; give the "
      "configuration of this camera, correct its size, or replace it with --force",
      target.config_path, rig.width_px, rig.height_px, what, camera.width_px, camera.height_px));
}

/// Writes the lens parameters into the rig, with a note on their source. Throws io::FileError and
/// io::ConfigError, and then leaves every file unchanged.
void write_rig_camera(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                      const std::string& note, bool quiet) {
  if (target.out_path.empty()) return;
  write_rig(target.config_path, target.out_path, io::camera_values(camera),
            "orchard calibrate camera", note, quiet);
  if (!quiet && !target.config_path.empty()) {
    std::printf(
        "delta_m and phi_rad depend on the intrinsics: run `orchard calibrate laser-camera` "
        "again\n");
  }
}

using calibration::CameraCalibration;

std::string pm(double value, double sd, int digits) {
  return fixed_text(value, digits) + " +- " + fixed_text(sd, digits);
}

void print_camera(const geometry::CameraIntrinsics& camera) {
  for (const io::ConfigValue& value : io::camera_values(camera)) {
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
  fmt::print("focal length     {}, {} px\n", pm(camera.fc_px[0], calibration.fc_sd_px[0], 2),
             pm(camera.fc_px[1], calibration.fc_sd_px[1], 2));
  fmt::print("principal point  {}, {} px\n", pm(camera.cc_px[0], calibration.cc_sd_px[0], 2),
             pm(camera.cc_px[1], calibration.cc_sd_px[1], 2));
  constexpr std::array<const char*, 5> kNames{"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    fmt::print("{}               {}\n", kNames[i], pm(camera.kc[i], calibration.kc_sd[i], 5));
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

std::string note_of(const CameraCalibration& calibration, const std::string& source,
                    const calibration::BoardConfig& board, std::size_t num_reasons) {
  std::string note = fmt::format(
      "{} views in {}, chessboard {} x {} of {:.1f} mm, rms {:.3f} px; sd fc {:.2f}, {:.2f}, cc "
      "{:.2f}, "
      "{:.2f} px",
      calibration.num_views, source, board.columns, board.rows, 1e3 * board.square_m,
      calibration.rms_px, calibration.fc_sd_px[0], calibration.fc_sd_px[1], calibration.cc_sd_px[0],
      calibration.cc_sd_px[1]);
  if (num_reasons > 0) note += fmt::format("; FORCED despite {} failed checks", num_reasons);
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
    print_camera(imported.intrinsics);
  }
  const std::string note = "imported from " + imported.kind + " " +
                           std::filesystem::path(options.import_path).filename().string();
  write_rig_camera(target, imported.intrinsics, note, options.quiet);
  return bus::kExitOk;
}

/// Selects the views to use: the most different ones if there are many.
std::vector<calibration::NamedView> selected_views(const BoardViews& found, bool quiet) {
  std::vector<calibration::NamedView> views;
  for (const std::size_t i :
       calibration::select_spread(found.views, found.width_px, found.height_px, kMaxViews)) {
    views.push_back(found.views[i]);
  }
  if (!quiet && views.size() < found.views.size()) {
    std::printf("using %zu of %zu views, the most different ones\n", views.size(),
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
  const calibration::BoardConfig& board = options.board;
  if (const auto problem = calibration::problem_with(board)) throw io::FileError(*problem);
  const RigTarget target = rig_target(options.config_path, options.out_path);

  const BoardViews found = find_board_views(options.paths, board, options.quiet);
  geometry::CameraIntrinsics pictures;
  pictures.width_px = found.width_px;
  pictures.height_px = found.height_px;
  check_size(target, pictures, "the pictures (" + found.views.front().name + ")", options.force);
  warn_of_pictures_without_board(found);

  calibration::CameraCalibrationOptions how;
  how.estimate_k3 = options.estimate_k3;
  const CameraCalibration calibration = naming(found.source, [&] {
    return calibration::calibrate_camera(selected_views(found, options.quiet), found.width_px,
                                         found.height_px, how);
  });
  if (!options.quiet) print_calibration(calibration);
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
