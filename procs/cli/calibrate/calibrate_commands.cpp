// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "cli/add_command.hpp"
#include "cli/calibrate/calibrate_appearance.hpp"
#include "cli/calibrate/calibrate_camera.hpp"
#include "cli/calibrate/calibrate_delay.hpp"
#include "cli/calibrate/calibrate_probability.hpp"
#include "cli/calibrate/calibrate_trunks.hpp"

namespace orchard::cli {
namespace {

void add_rig_to_write(CLI::App& command, std::string& out_path) {
  command
      .add_option("--out", out_path,
                  "rig to write; without it that of --config, the old one kept as .bak")
      ->type_name("FILE");
}

void add_board_options(CLI::App& command, calibration::BoardConfig& board, std::string& kind) {
  command.add_option("--board", kind, "chessboard or charuco")
      ->check(CLI::IsMember({"chessboard", "charuco"}))
      ->capture_default_str();
  command
      .add_option("--columns", board.columns,
                  "inner corners (chessboard) or squares (charuco) along a row")
      ->capture_default_str();
  command.add_option("--rows", board.rows, "and along a column")->capture_default_str();
  command.add_option("--square-m", board.square_m, "side of a square, measured on the board [m]")
      ->capture_default_str();
  command.add_option("--marker-m", board.marker_m, "side of a charuco marker [m]")
      ->capture_default_str();
  command.add_option("--dictionary", board.dictionary, "of the charuco markers")
      ->capture_default_str();
}

constexpr const char* kCameraExamples =
    "  orchard calibrate camera pictures/ --columns 8 --rows 6 --square-m 0.03 --out "
    "mine.yaml\n"
    "  orchard calibrate camera board.lcm --board charuco --columns 7 --rows 5 --square-m 0.04 \\\n"
    "      --marker-m 0.03 --config config/tubes.yaml --out mine.yaml --coverage seen.png\n"
    "  orchard calibrate camera --import Calib_Results.m --out mine.yaml\n";

void add_camera(CLI::App& calibrate, Run& run) {
  add_command<CalibrateCameraOptions>(
      calibrate, run, "camera",
      "Measure a camera's intrinsics from pictures of a board, judge them, and write them into the "
      "rig's YAML; or import them",
      (std::string(kCameraExamples) +
       "Show the board 20 times: in every corner of the picture, tilted to all four sides, near "
       "and\n"
       "far. A result that should not be used is not written: exit code 3, with what is missing.\n"
       "--import reads Bouguet's Calib_Results.m, ROS camera_info (plumb_bob) and OpenCV YAML.\n")
          .c_str(),
      run_calibrate_camera, [](CLI::App& command, CalibrateCameraOptions& o) {
        command
            .add_option("pictures", o.paths,
                        "JPEG or PNG files, folders of them, or one log with IMAGE messages")
            ->type_name("PICTURES...|LOG");
        command.add_option("--import", o.import_path, "another tool's result instead of pictures")
            ->type_name("FILE");
        add_board_options(command, o.board, o.board_kind);
        command.add_option("--config", o.config_path, "rig to start from")->type_name("FILE");
        command
            .add_option("--out", o.out_path,
                        "rig to write; without it that of --config, the old one kept as .bak; "
                        "without both nothing is written")
            ->type_name("FILE");
        command
            .add_option("--coverage", o.coverage_path,
                        "draw where corners were seen and how far the model misses them")
            ->type_name("SVG|PNG|PDF");
        command.add_option("--max-views", o.max_views, "the most different ones are used")
            ->check(CLI::Range(3, 200))
            ->capture_default_str();
        command.add_flag("--k3", o.estimate_k3,
                         "also estimate k3: wide lenses at more than 640 pixels");
        command.add_flag("--force", o.force,
                         "write a result that should not be used, or of another picture size");
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
      });
}

const char* const kDelayExamples =
    "  orchard calibrate delay curves.lcm --config mine.yaml --out config/timed.yaml\n";

void add_calibrate_delay(CLI::App& calibrate, Run& run) {
  add_command<CalibrateDelayOptions>(
      calibrate, run, "delay",
      "Measure how much earlier than its time stamp a picture is exposed, from drives with curves "
      "past trunks, and write camera.delay_s into the rig's YAML",
      kDelayExamples, run_calibrate_delay, [](CLI::App& command, CalibrateDelayOptions& o) {
        command.add_option("logs", o.log_paths, "drives with curves to both sides past trunks")
            ->required()
            ->type_name("LOG...");
        command.add_option("--config", o.config_path, "the rig they were recorded with")
            ->required()
            ->type_name("FILE");
        add_rig_to_write(command, o.out_path);
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
      });
}

void add_appearance(CLI::App& calibrate, Run& run) {
  const char* examples =
      "  orchard calibrate appearance a.lcm b.lcm --observations a.csv b.csv \\\n"
      "    --config config/orchard.yaml --out mine.yaml\n";
  add_command<CalibrateAppearanceOptions>(
      calibrate, run, "appearance",
      "Learn what trunks look like from drives with a known truth, and write it into the rig's "
      "YAML (from pictures with masks: calibrate trunks)",
      examples, run_calibrate_appearance, [](CLI::App& command, CalibrateAppearanceOptions& o) {
        command.add_option("logs", o.log_paths, "drives with scans and pictures")
            ->required()
            ->type_name("LOG...");
        command
            .add_option("--observations", o.observation_paths,
                        "what each scan truly held (orchard simulate --observations), one per log")
            ->required()
            ->type_name("CSV...");
        command.add_option("--config", o.config_path, "the rig")->required()->type_name("FILE");
        add_rig_to_write(command, o.out_path);
        command.add_option("--stride", o.stride, "look at every how manieth scan")
            ->check(CLI::Range(1, 1000))
            ->capture_default_str();
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
      });
}

void add_probability(CLI::App& calibrate, Run& run) {
  const char* examples =
      "  orchard calibrate probability a.lcm b.lcm --observations a.csv b.csv \\\n"
      "    --config config/orchard.yaml --out mine.yaml\n";
  add_command<CalibrateProbabilityOptions>(
      calibrate, run, "probability",
      "Learn from logs with a known truth what probability of a tree the detector's measurements "
      "stand for, and write it into the rig's YAML",
      examples, run_calibrate_probability, [](CLI::App& command, CalibrateProbabilityOptions& o) {
        command
            .add_option("logs", o.log_paths,
                        "drives (with scans: this rig's detector looks at them anew; else their "
                        "detections are taken)")
            ->required()
            ->type_name("LOG...");
        command
            .add_option("--observations", o.observation_paths,
                        "what each scan truly held (orchard simulate --observations), one per log")
            ->required()
            ->type_name("CSV...");
        command.add_option("--config", o.config_path, "the rig")->required()->type_name("FILE");
        add_rig_to_write(command, o.out_path);
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
      });
}

}  // namespace

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App* calibrate = app.add_subcommand("calibrate", "Measure a rig's models from recordings");
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
      "Measure width and hue of the trunks in logs (the paper's initialisation), or what trunks "
      "look like in pictures with masks, and write it into the rig's YAML",
      examples, run_calibrate_trunks, [](CLI::App& command, CalibrateTrunksOptions& o) {
        command.add_option("logs", o.log_paths, "drives past trunks of one kind")
            ->type_name("LOG...");
        command
            .add_option("--config", o.config_path,
                        "the rig they were recorded with; with --images the defaults without it")
            ->type_name("FILE");
        MaskedPictureOptions& pictures = o.pictures;
        CLI::Option* images =
            command
                .add_option("--images", pictures.picture_folder,
                            "learn from pictures instead, windows on trunks against elsewhere")
                ->type_name("DIR");
        command
            .add_option("--masks", pictures.mask_folder,
                        "masks of the same names, trunks red; with --images")
            ->needs(images)
            ->type_name("DIR");
        command.add_option("--only", pictures.only, "numbers of the pictures, such as 000-019")
            ->needs(images);
        add_rig_to_write(command, o.out_path);
        command.add_option("--wanted-trunks", o.wanted_trunks, "fewer give a warning")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        const std::map<std::string, ColourChoice> choices{
            {"auto", ColourChoice::kAuto},
            {"hue_interval", ColourChoice::kHueInterval},
            {"appearance", ColourChoice::kAppearance}};
        command
            .add_option("--colour-model", o.colour_model,
                        "hue_interval, appearance, or auto: the one that tells trunks better")
            ->transform(CLI::CheckedTransformer(choices))
            ->type_name("MODEL");
        CLI::Option* list =
            command
                .add_option("--list", o.list_folder,
                            "write a page with a picture of each thing seen, to pick from; "
                            "changes no rig")
                ->type_name("DIR");
        CLI::Option* trees =
            command
                .add_option("--trees", o.trees, "the things of that page that are trunks: 3,7,9-20")
                ->excludes(list);
        CLI::Option* map =
            command.add_option("--map", o.map_folder, "a first map, whose landmarks --ids names")
                ->excludes(list)
                ->excludes(trees)
                ->type_name("DIR");
        CLI::Option* ids = command.add_option("--ids", o.ids, "its landmarks that are trunks: 4,8");
        ids->needs(map);
        map->needs(ids);
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
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
  add_appearance(*calibrate, run);
  add_probability(*calibrate, run);
  add_calibrate_laser_camera(*calibrate, run);
  add_calibrate_delay(*calibrate, run);
  calibrate->footer(std::string("Examples:\n") + kCameraExamples + examples + kDelayExamples);
}

}  // namespace orchard::cli
