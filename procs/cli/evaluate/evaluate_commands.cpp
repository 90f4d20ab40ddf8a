// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "cli/add_command.hpp"
#include "cli/evaluate/evaluate.hpp"
#include "cli/evaluate/evaluate_detections.hpp"
#include "cli/evaluate/evaluate_trajectory.hpp"
#include "cli/evaluate/evaluate_windows.hpp"

namespace orchard::cli {

namespace {

void add_map_options(CLI::App& command, EvaluateOptions& o, bool required) {
  command.add_option("map", o.map_path, "map.csv, or the folder with one")
      ->required(required)
      ->type_name("FOLDER|CSV");
  command.add_option("--truth", o.truth_path, "what stands there: class,x_m,y_m,width_m")
      ->required(required)
      ->type_name("CSV");
  command
      .add_option("--poses", o.poses_path,
                  "where the robot truly was: judge the trajectory.csv beside the map too")
      ->type_name("CSV");
  command.add_option("--gate", o.gate_m, "farthest a landmark lies from its object [m]")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  auto* align = command.add_flag(
      "--align", o.align, "lay the map upon the truth by its trees first (a map without a place)");
  command
      .add_option("--align-offset", o.search.offset_max_m,
                  "how far off its middle may be [m]; with --poses the path helps")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str()
      ->needs(align);
  command
      .add_option("--align-turn", o.search.turn_max_rad, "how far it may be turned about it [rad]")
      ->check(CLI::Range(0.0, 3.15))
      ->capture_default_str()
      ->needs(align);
  command.add_flag("--json", o.json, "for programs; lengths in metres");
  command.add_flag("--check", o.check,
                   "exit 1 unless all is found once, with its class, and nothing else");
}

void add_window_options(CLI::App& command, EvaluateWindowsOptions& o) {
  MaskedPictureOptions& pictures = o.pictures;
  calibration::MaskWindowOptions& windows = pictures.windows;
  command.add_option("--images", pictures.picture_folder, "pictures")->required()->type_name("DIR");
  command.add_option("--masks", pictures.mask_folder, "masks of the same names, trunks red")
      ->required()
      ->type_name("DIR");
  command.add_option("--model", o.model_path, "rig with a learnt detector.appearance")
      ->required()
      ->type_name("FILE");
  command.add_option("--only", pictures.only, "numbers of the pictures, such as 020-118");
  command.add_flag("--json", o.json, "for programs");
  command.add_option("--worst", o.worst_path, "also draw the worst mistakes")->type_name("PNG");
  command.add_option("--per-picture", windows.per_class, "windows of each kind in a picture")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command.add_option("--aspect-min", windows.aspect_min, "height of windows over their width")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  command.add_option("--aspect-max", windows.aspect_max, "and of the tallest")
      ->check(CLI::Range(0.1, 20.0))
      ->capture_default_str();
  command.add_option("--width-scale", windows.width_scale, "of the trunk's width")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command
      .add_option("--scatter", windows.scatter,
                  "windows are off by up to this fraction of their width")
      ->check(CLI::Range(0.0, 0.9))
      ->capture_default_str();
  command.add_option("--seed", windows.seed, "where windows lie follows from it")
      ->capture_default_str();
  command.add_option("--exposure", o.disturbance.exposure_ev, "brighten the pictures first [EV]")
      ->check(CLI::Range(-8.0, 8.0));
  command.add_option("--red-gain", o.disturbance.red_gain, "of the light: a wrong white balance")
      ->check(CLI::Range(0.1, 10.0));
  command.add_option("--blue-gain", o.disturbance.blue_gain, "of the light")
      ->check(CLI::Range(0.1, 10.0));
  command.add_option("--blur", o.disturbance.blur_px, "blur the pictures first [px]")
      ->check(CLI::Range(0.0, 100.0));
}

void add_detections(CLI::App& evaluate, Run& run) {
  const char* examples =
      "  orchard simulate --scene orchard --seed 1 --out drive.lcm --truth truth.csv \\\n"
      "    --observations looks.csv --config config/orchard.yaml\n"
      "  orchard map drive.lcm --config config/orchard.yaml --out out/drive\n"
      "  orchard evaluate detections out/drive --observations looks.csv --truth truth.csv \\\n"
      "    --html out/detections.html\n"
      "  orchard evaluate detections noon evening --observations noon.csv evening.csv   (by "
      "light)\n";
  add_command<EvaluateDetectionsOptions>(
      evaluate, run, "detections",
      "Compare detections with the truth of each scan: precision, recall and F1 of class tree, the "
      "paper's three tests, and whether probabilities mean what they say",
      examples, run_evaluate_detections, [](CLI::App& command, EvaluateDetectionsOptions& o) {
        command.add_option("recordings", o.paths, "map folders, or logs with detections")
            ->required()
            ->type_name("FOLDER|LOG...");
        command
            .add_option("--observations", o.observation_paths,
                        "what each scan truly held (orchard simulate --observations), one per "
                        "recording")
            ->required()
            ->type_name("CSV...");
        command
            .add_option("--truth", o.truth_paths,
                        "what stands there, one per recording: judge the landmarks too")
            ->type_name("CSV...");
        command.add_option("--html", o.html_path, "write tables and plots as one page")
            ->type_name("PAGE");
        command.add_flag("--json", o.json, "for programs; lengths in metres");
        command.add_option("--range", o.rules.range_max_m, "count what is nearer than this [m]")
            ->check(CLI::Range(0.1, 100.0))
            ->capture_default_str();
        command.add_option("--min-beams", o.rules.num_beams_min, "count what so many beams hit")
            ->check(CLI::Range(1, 10000))
            ->capture_default_str();
        command
            .add_option("--hidden", o.rules.hidden_max,
                        "count what has at most this fraction behind nearer things")
            ->check(CLI::Range(0.0, 1.0))
            ->capture_default_str();
        command
            .add_option("--gate", o.rules.gate_m, "farthest a detection lies from its thing [m]")
            ->check(CLI::Range(0.001, 10.0))
            ->capture_default_str();
        command.add_flag("--without-picture", o.without_picture,
                         "count what is not whole in a picture, too (a rig without a camera)");
      });
}

void add_trajectory(CLI::App& evaluate, Run& run) {
  add_command<EvaluateTrajectoryOptions>(
      evaluate, run, "trajectory",
      "Compare where the robot was thought to be with where it was: ATE and RPE",
      "  orchard evaluate trajectory out/drive --truth poses.csv --align\n"
      "  orchard evaluate trajectory out/drive/trajectory.csv --truth track.csv --align \\\n"
      "      --delta 10 --unit m --figure errors.png\n"
      "  orchard evaluate trajectory out/drive --truth track.csv --nearest --max-difference 0.02 "
      "--json\n"
      "Figures are those of evo_ape and evo_rpe (evo 1.x), in the plane; the truth may have gaps\n"
      "and need not have headings. What is true at a pose's time is interpolated, never across a "
      "gap.\n",
      run_evaluate_trajectory, [](CLI::App& command, EvaluateTrajectoryOptions& o) {
        command
            .add_option("trajectory", o.trajectory_path, "trajectory.csv, or the folder with one")
            ->required()
            ->type_name("FOLDER|CSV");
        command.add_option("--truth", o.truth_path, "utime_us,x_m,y_m and, if known, yaw_rad")
            ->required()
            ->type_name("CSV");
        auto* align = command.add_flag("--align", o.align,
                                       "turn and move it for the least squared distances first");
        command
            .add_flag("--align-origin", o.align_origin, "lay its first pose on the truth's first")
            ->excludes(align);
        command.add_flag("--nearest", o.nearest,
                         "compare with the nearest pose in time instead of interpolating");
        command
            .add_option("--max-difference", o.rules.max_difference_s,
                        "farthest in time that the nearest may be [s]")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        command
            .add_option("--gap", o.gap_max_s,
                        "true poses farther apart are a gap [s]; 0 = three median intervals")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
        command.add_option("--delta", o.rules.delta, "of RPE: how far from pose to pose")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        using evaluation::DeltaUnit;
        command.add_option("--unit", o.rules.unit, "of --delta: m, s or frames")
            ->transform(CLI::CheckedTransformer(
                std::map<std::string, DeltaUnit>{{"m", DeltaUnit::kMetres},
                                                 {"s", DeltaUnit::kSeconds},
                                                 {"frames", DeltaUnit::kFrames}}))
            ->default_str("m");
        command.add_flag("--all-pairs", o.rules.all_pairs,
                         "RPE from every pose on, not one stretch after the other");
        command.add_flag("--json", o.json, "for programs; metres and radians");
        command
            .add_option("--figure", o.figure_path,
                        "draw the two paths and the error over the distance")
            ->type_name("SVG|PNG|PDF");
      });
}

}  // namespace

void add_evaluate(CLI::App& app, Run& run) {
  const char* examples =
      "  orchard evaluate out/drive --truth truth.csv        (evaluate map, in short)\n"
      "  orchard evaluate map out/drive/map.csv --truth truth.csv --json > evaluation.json\n"
      "  orchard evaluate out/drive --truth truth.csv --check && echo perfect\n"
      "  orchard evaluate map out/drive --truth truth.csv --poses poses.csv --align\n"
      "  orchard evaluate trajectory out/drive --truth poses.csv --align\n"
      "  orchard evaluate windows --images pictures --masks masks --model model.yaml\n";
  CLI::App& evaluate = add_subcommand(
      app, "evaluate", "Compare results with the truth: the paper's tables, and the errors",
      examples);
  const auto options = std::make_shared<EvaluateOptions>();
  add_map_options(evaluate, *options, false);
  on_command(evaluate, [&run, options] {
    if (options->map_path.empty()) throw CLI::RequiredError("map");
    if (options->truth_path.empty()) throw CLI::RequiredError("--truth");
    run = [options] { return run_evaluate(*options); };
  });
  evaluate.require_subcommand(0, 1);
  add_command<EvaluateOptions>(
      evaluate, run, "map", "Compare a map with the truth", examples, run_evaluate,
      [](CLI::App& command, EvaluateOptions& o) { add_map_options(command, o, true); });
  add_command<EvaluateWindowsOptions>(
      evaluate, run, "windows",
      "Tell how well a learnt model tells windows on trunks from windows elsewhere",
      "  orchard evaluate windows --images pictures --masks masks --model model.yaml --only "
      "020-118\n"
      "  orchard evaluate windows --images pictures --masks masks --model model.yaml --json \\\n"
      "      --exposure -1 --blur 1.5\n",
      run_evaluate_windows, add_window_options);
  add_detections(evaluate, run);
  add_trajectory(evaluate, run);
}

}  // namespace orchard::cli
