// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/calibrate/calibrate_laser_camera.hpp"

namespace orchard::cli {

void add_calibrate_laser_camera(CLI::App& calibrate, Run& run) {
  add_command<CalibrateLaserCameraOptions>(
      calibrate, run, "laser-camera",
      "Find where the laser is at the camera from a log of a board held before both, and write it "
      "into the rig's YAML",
      "  orchard calibrate laser-camera board.lcm --config rig.yaml --columns 7 --rows 5 \\\n"
      "      --square-m 0.08 --board-width-m 0.72 --board-height-m 0.56 --out calibrated.yaml\n"
      "  orchard calibrate laser-camera --import toolbox.txt --config rig.yaml --out mine.yaml\n"
      "Hold the board still for a second in 15 to 25 places where the scan plane cuts it, near "
      "and\n"
      "far, tilted by 20 to 45 degrees to the left and right, forward and back.\n",
      run_calibrate_laser_camera, [](CLI::App& command, CalibrateLaserCameraOptions& o) {
        command.add_option("log", o.log_path, "the board before both sensors")->type_name("LOG");
        command.add_option("--config", o.config_path, "the rig it was recorded with")
            ->required()
            ->type_name("FILE");
        command
            .add_option("--out", o.out_path,
                        "rig to write; without it that of --config, the old one kept as .bak")
            ->type_name("FILE");
        command.add_option("--board", o.board_kind, "chessboard or charuco")
            ->check(CLI::IsMember({"chessboard", "charuco"}))
            ->capture_default_str();
        command
            .add_option("--columns", o.board.columns, "inner corners (charuco: squares) per row")
            ->capture_default_str();
        command.add_option("--rows", o.board.rows, "and per column")->capture_default_str();
        command.add_option("--square-m", o.board.square_m, "side of a square")
            ->type_name("M")
            ->capture_default_str();
        command.add_option("--marker-m", o.board.marker_m, "side of a marker (charuco)")
            ->type_name("M")
            ->capture_default_str();
        command.add_option("--dictionary", o.board.dictionary, "of the markers (charuco)")
            ->capture_default_str();
        CLI::Option* width =
            command
                .add_option("--board-width-m", o.board_width_m,
                            "outer width of the whole board, pattern in its middle")
                ->check(CLI::PositiveNumber)
                ->type_name("M");
        CLI::Option* height =
            command.add_option("--board-height-m", o.board_height_m, "and its outer height")
                ->check(CLI::PositiveNumber)
                ->type_name("M");
        width->needs(height);
        height->needs(width);
        command.add_option("--max-views", o.max_views, "use at most that many, well spread")
            ->check(CLI::Range(6, 200))
            ->capture_default_str();
        command.add_flag("--any-mount", o.any_mount,
                         "believe the data where it contradicts the mount that the YAML states");
        command
            .add_option("--import", o.import_path,
                        "delta and phi as Kassir and Peynot's toolbox prints them, instead of LOG")
            ->type_name("FILE");
        command
            .add_option("--axes", o.import_axes,
                        "of the laser in that file: toolbox (x left, y up, z forward) or orchard "
                        "(x forward, y left, z up)")
            ->check(CLI::IsMember({"toolbox", "orchard"}))
            ->capture_default_str();
        command.add_option("--angles", o.import_angles, "unit of its phi when it states none")
            ->check(CLI::IsMember({"stated", "deg", "rad"}))
            ->capture_default_str();
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
      });
}

}  // namespace orchard::cli
