// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "cli/add_command.hpp"
#include "cli/calibrate/calibrate.hpp"

namespace orchard::cli {
namespace {

void add_rig_to_write(CLI::App& command, std::string& out_path) {
  add_value(command, "--out", out_path, "FILE",
            "configuration to write [that of --config; its old version is kept as .bak]");
}

void add_board_options(CLI::App& command, calibration::BoardConfig& board, std::string& kind) {
  command.add_option("--board", kind, "pattern of the board: chessboard or charuco")
      ->check(CLI::IsMember({"chessboard", "charuco"}))
      ->capture_default_str();
  command
      .add_option("--columns", board.columns,
                  "inner corners (chessboard) or squares (charuco) per row")
      ->capture_default_str();
  command
      .add_option("--rows", board.rows,
                  "inner corners (chessboard) or squares (charuco) per column")
      ->capture_default_str();
  command.add_option("--square-m", board.square_m, "side of a square, measured with a ruler [m]")
      ->capture_default_str();
  command.add_option("--marker-m", board.marker_m, "side of a charuco marker [m]")
      ->capture_default_str();
  command.add_option("--dictionary", board.dictionary, "dictionary of the charuco markers")
      ->capture_default_str();
}

constexpr const char* kCameraExamples =
    "  orchard calibrate camera pictures/ --columns 8 --rows 6 --square-m 0.03 --out mine.yaml\n"
    "  orchard calibrate camera board.lcm --board charuco --columns 7 --rows 5 --square-m 0.04 \\\n"
    "      --marker-m 0.03 --config config/tubes.yaml --out mine.yaml --coverage seen.png\n"
    "  orchard calibrate camera --import Calib_Results.m --out mine.yaml\n";

void add_camera(CLI::App& calibrate, Run& run) {
  add_command<CalibrateCameraOptions>(
      calibrate, run, "camera",
      "Measure the intrinsics of a camera from pictures of a board, check them, and write them "
      "into the rig's YAML",
      (std::string(kCameraExamples) +
       "Input: about 20 pictures of the board, in every corner of the picture, tilted to all\n"
       "four sides, near and far. Output: camera.fc_px, cc_px, alpha_c and kc of the rig. A poor\n"
       "result is not written: exit code 3, with the views to add. --import reads Bouguet's\n"
       "Calib_Results.m, ROS camera_info (plumb_bob) and OpenCV YAML instead.\n")
          .c_str(),
      run_calibrate_camera, [](CLI::App& command, CalibrateCameraOptions& o) {
        add_value(command, "pictures", o.paths, "PICTURES...|LOG",
                  "JPEG or PNG files, folders of them, or one log with IMAGE messages");
        add_value(command, "--import", o.import_path, "FILE",
                  "import the result of another tool instead of pictures");
        add_board_options(command, o.board, o.board_kind);
        add_value(command, "--config", o.config_path, "FILE", "rig whose configuration is updated");
        add_value(command, "--out", o.out_path, "FILE",
                  "configuration to write [that of --config; its old version is kept as "
                  ".bak]; without both options nothing is written");
        add_value(command, "--coverage", o.coverage_path, "SVG|PNG|PDF",
                  "draw the corners found and their distance from the model");
        add_limited(command, "--max-views", o.max_views, 3, 200,
                    "use at most this many views, the most different ones");
        command.add_flag("--k3", o.estimate_k3,
                         "also estimate k3, for wide lenses and pictures wider than 640 pixels");
        command.add_flag("--force", o.force,
                         "write a poor result, or one for another picture size");
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
      });
}

void add_laser_camera(CLI::App& calibrate, Run& run) {
  add_command<CalibrateLaserCameraOptions>(
      calibrate, run, "laser-camera",
      "Measure the pose of the laser relative to the camera from a log of a board, and write it "
      "into the rig's YAML",
      "  orchard calibrate laser-camera board.lcm --config rig.yaml --columns 7 --rows 5 \\\n"
      "      --square-m 0.08 --board-width-m 0.72 --board-height-m 0.56 --out calibrated.yaml\n"
      "  orchard calibrate laser-camera --import toolbox.txt --config rig.yaml --out mine.yaml\n"
      "Input: a log with SCAN and IMAGE. Hold the board still for a second in 15 to 25 places\n"
      "where the scan plane cuts it, near and far, tilted by 20 to 45 degrees to the left and\n"
      "right, forward and back. Output: camera.delta_m and camera.phi_rad of the rig.\n",
      run_calibrate_laser_camera, [](CLI::App& command, CalibrateLaserCameraOptions& o) {
        add_value(command, "log", o.log_path, "LOG",
                  "log of the board in view of laser and camera");
        add_required(command, "--config", o.config_path, "FILE", "rig of the recording");
        add_rig_to_write(command, o.out_path);
        add_board_options(command, o.board, o.board_kind);
        CLI::Option* width =
            add_value(command, "--board-width-m", o.board_width_m, "M",
                      "outer width of the whole board, with the pattern in its middle")
                ->check(CLI::PositiveNumber);
        CLI::Option* height = add_value(command, "--board-height-m", o.board_height_m, "M",
                                        "outer height of the whole board")
                                  ->check(CLI::PositiveNumber);
        width->needs(height);
        height->needs(width);
        add_limited(command, "--max-views", o.max_views, 6, 200,
                    "use at most this many views, the most different ones");
        command.add_flag("--any-mount", o.any_mount,
                         "accept a result that contradicts the extrinsics stated in the YAML");
        add_value(command, "--import", o.import_path, "FILE",
                  "import delta and phi as printed by Kassir and Peynot's toolbox, instead of LOG");
        command
            .add_option("--axes", o.import_axes,
                        "axes of the laser in the imported file: toolbox (x left, y up, z forward) "
                        "or orchard (x forward, y left, z up)")
            ->check(CLI::IsMember({"toolbox", "orchard"}))
            ->capture_default_str();
        command
            .add_option("--angles", o.import_angles,
                        "unit of phi in the imported file, if the file does not state it")
            ->check(CLI::IsMember({"stated", "deg", "rad"}))
            ->capture_default_str();
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
      });
}

const char* const kDelayExamples =
    "  orchard calibrate delay curves.lcm --config mine.yaml --out config/timed.yaml\n"
    "Input: drives with ODOMETRY in curves to both sides past trunks. Output: camera.delay_s of\n"
    "the rig; with --laser or without a camera drivers.laser.delay_s, which the driver subtracts "
    "from\n"
    "the stamps of later drives (then measure the camera's anew).\n";

void add_delay(CLI::App& calibrate, Run& run) {
  add_command<CalibrateDelayOptions>(
      calibrate, run, "delay",
      "Measure the delay from the exposure of a picture to its time stamp, or that of the scans "
      "after "
      "the wheels, and write it into the rig's YAML",
      kDelayExamples, run_calibrate_delay, [](CLI::App& command, CalibrateDelayOptions& o) {
        add_required(command, "logs", o.log_paths, "LOG...",
                     "logs of drives in curves to both sides past trunks");
        add_required(command, "--config", o.config_path, "FILE", "rig of the recordings");
        add_rig_to_write(command, o.out_path);
        command.add_flag("--laser", o.of_laser, "measure the scanners, although there is a camera");
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
      });
}

void add_probability(CLI::App& calibrate, Run& run) {
  const char* examples =
      "  orchard calibrate probability drive.lcm --map out/drive --ids 4,8,10-31 --config "
      "mine.yaml\n"
      "  orchard calibrate probability a.lcm b.lcm --map out/a out/b --config mine.yaml\n"
      "To judge by the probabilities, set detector.decision: probability and mapper.evidence:\n"
      "probability.\n";
  add_command<CalibrateProbabilityOptions>(
      calibrate, run, "probability",
      "Calibrate the probabilities of tree and object from maps whose trees a person "
      "picked, and write them into the rig's YAML",
      examples, run_calibrate_probability, [](CLI::App& command, CalibrateProbabilityOptions& o) {
        add_required(command, "logs", o.log_paths, "LOG...",
                     "logs of drives; the detector is run on logs with scans, otherwise the "
                     "logged detections are used");
        add_required(command, "--map", o.map_folders, "DIR...",
                     "maps of the logs (orchard map), one per log; learnt are their classes as "
                     "corrected with orchard edit");
        command.add_option("--ids", o.ids,
                           "ids of the landmarks of a single map that are trees, all others being "
                           "objects: 4,8,10-31");
        add_required(command, "--config", o.config_path, "FILE", "rig of the recordings");
        add_rig_to_write(command, o.out_path);
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
        command.parse_complete_callback([&o] {
          if (!o.ids.empty() && o.map_folders.size() > 1) {
            throw CLI::ValidationError("--ids", "ids of landmarks need a single --map");
          }
        });
      });
}

}  // namespace

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App* calibrate = app.add_subcommand(
      "calibrate",
      "Calibrate a rig from recordings: camera, extrinsics, delay, trunk model, probabilities");
  calibrate->require_subcommand(1);
  add_camera(*calibrate, run);
  const char* examples =
      "  orchard calibrate trunks drive.lcm --config config/tubes.yaml --out mine.yaml\n"
      "  orchard calibrate trunks one.lcm two.lcm --config mine.yaml\n"
      "  orchard calibrate trunks drive.lcm --config mine.yaml --list out/things\n"
      "  orchard calibrate trunks drive.lcm --config mine.yaml --trees 3,7,9-20\n"
      "  orchard calibrate trunks drive.lcm --config mine.yaml --map out/drive --ids 4,8\n"
      "  orchard calibrate trunks --images pictures --masks masks --only 000-019 --out "
      "model.yaml\n";
  add_command<CalibrateTrunksOptions>(
      *calibrate, run, "trunks",
      "Measure the width, hue and appearance of trunks from logs or masked pictures and write them "
      "into the rig's YAML",
      examples, run_calibrate_trunks, [](CLI::App& command, CalibrateTrunksOptions& o) {
        add_value(command, "logs", o.log_paths, "LOG...", "logs of drives past trunks of one kind");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig of the recordings; with --images optional [built-in defaults]");
        MaskedPictureOptions& pictures = o.pictures;
        CLI::Option* images = add_value(command, "--images", pictures.picture_folder, "DIR",
                                        "learn the appearance from pictures instead of logs");
        add_value(command, "--masks", pictures.mask_folder, "DIR",
                  "masks of the pictures, with the same names and trunks in red")
            ->needs(images);
        command
            .add_option("--only", pictures.only, "numbers of the pictures to use, such as 000-019")
            ->needs(images);
        add_rig_to_write(command, o.out_path);
        command.add_option("--wanted-trunks", o.wanted_trunks, "warn if fewer trunks are found")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        const std::map<std::string, ColourChoice> choices{
            {"auto", ColourChoice::kAuto},
            {"hue_interval", ColourChoice::kHueInterval},
            {"appearance", ColourChoice::kAppearance}};
        add_value(command, "--colour-model", o.colour_model, "MODEL",
                  "hue_interval, appearance, or auto: the better one of both")
            ->transform(CLI::CheckedTransformer(choices));
        const std::map<std::string, DecisionChoice> decisions{
            {"auto", DecisionChoice::kAuto},
            {"roc", DecisionChoice::kRoc},
            {"probability", DecisionChoice::kProbability}};
        add_value(command, "--decision", o.decision, "DECISION",
                  "how the detector decides: roc, as the paper, probability, with weights "
                  "learnt here, or auto: the one with fewer errors on left-out objects")
            ->transform(CLI::CheckedTransformer(decisions));
        CLI::Option* list = add_value(
            command, "--list", o.list_folder, "DIR",
            "only write a page with a picture of each object found, to choose trunks from");
        CLI::Option* trees =
            command
                .add_option("--trees", o.trees,
                            "numbers of all trunks on the page of --list, the rest being something "
                            "else: 3,7,9-20")
                ->excludes(list);
        CLI::Option* map = add_value(command, "--map", o.map_folder, "DIR",
                                     "map of the log, to choose its landmarks by --ids")
                               ->excludes(list)
                               ->excludes(trees);
        CLI::Option* ids =
            command.add_option("--ids", o.ids,
                               "ids of all landmarks of --map that are trunks, the rest being "
                               "something else: 4,8");
        ids->needs(map);
        map->needs(ids);
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
        command.parse_complete_callback([&o] {
          const MaskedPictureOptions& p = o.pictures;
          if (p.picture_folder.empty()) {
            if (o.log_paths.empty()) throw CLI::RequiredError("logs (or --images and --masks)");
            if (o.config_path.empty()) throw CLI::RequiredError("--config");
            return;
          }
          if (!o.log_paths.empty()) throw CLI::ExcludesError("--images", "logs");
          if (p.mask_folder.empty()) throw CLI::RequiredError("--masks");
          if (o.out_path.empty() && o.config_path.empty()) throw CLI::RequiredError("--out");
        });
      });
  add_probability(*calibrate, run);
  add_laser_camera(*calibrate, run);
  add_delay(*calibrate, run);
  calibrate->footer(std::string("Examples:\n") + kCameraExamples + examples + kDelayExamples);
}

}  // namespace orchard::cli
