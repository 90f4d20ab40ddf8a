// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/calibrate/calibrate_laser_camera.hpp"

namespace orchard::cli {

void add_calibrate_laser_camera(CLI::App& calibrate, Run& run) {
  add_command<CalibrateLaserCameraOptions>(
      calibrate, run, "laser-camera",
      "Measure the pose of the laser relative to the camera from a log of a board, and write it "
      "into the rig's YAML",
      "  orchard calibrate laser-camera board.lcm --config rig.yaml --columns 7 --rows 5 \\\n"
      "      --square-m 0.08 --board-width-m 0.72 --board-height-m 0.56 --out calibrated.yaml\n"
      "  orchard calibrate laser-camera --import toolbox.txt --config rig.yaml --out mine.yaml\n"
      "Input: a log with SCAN and IMAGE. Hold the board still for a second in 15 to 25 places "
      "where the scan\n"
      "plane cuts it, near and far, tilted by 20 to 45 degrees to the left and right, forward and "
      "back.\n"
      "Output: camera.delta_m and camera.phi_rad of the rig.\n",
      run_calibrate_laser_camera, [](CLI::App& command, CalibrateLaserCameraOptions& o) {
        add_value(command, "log", o.log_path, "LOG",
                  "log of the board in view of laser and camera");
        add_required(command, "--config", o.config_path, "FILE", "rig of the recording");
        add_value(command, "--out", o.out_path, "FILE",
                  "configuration to write [that of --config; its old version is kept as .bak]");
        command.add_option("--board", o.board_kind, "pattern of the board: chessboard or charuco")
            ->check(CLI::IsMember({"chessboard", "charuco"}))
            ->capture_default_str();
        command
            .add_option("--columns", o.board.columns,
                        "inner corners (chessboard) or squares (charuco) per row")
            ->capture_default_str();
        command
            .add_option("--rows", o.board.rows,
                        "inner corners (chessboard) or squares (charuco) per column")
            ->capture_default_str();
        add_value(command, "--square-m", o.board.square_m, "M",
                  "side of a square, measured with a ruler")
            ->capture_default_str();
        add_value(command, "--marker-m", o.board.marker_m, "M", "side of a charuco marker")
            ->capture_default_str();
        command.add_option("--dictionary", o.board.dictionary, "dictionary of the charuco markers")
            ->capture_default_str();
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

}  // namespace orchard::cli
