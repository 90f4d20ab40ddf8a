// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "cli/add_command.hpp"
#include "cli/evaluate/evaluate.hpp"
#include "cli/evaluate/evaluate_trajectory.hpp"

namespace orchard::cli {

namespace {

void add_map_options(CLI::App& command, EvaluateOptions& o, bool required) {
  add_value(command, "map", o.map_path, "FOLDER|CSV", "map folder, or its map.csv")
      ->required(required);
  add_value(command, "--truth", o.truth_path, "CSV", "true objects: class,x_m,y_m,width_m")
      ->required(required);
  add_value(command, "--poses", o.poses_path, "CSV",
            "true poses: also evaluate the trajectory.csv beside the map");
  add_limited(command, "--gate", o.gate_m, 0.001, 100.0,
              "max distance of a landmark from its object [m]");
  auto* align = command.add_flag(
      "--align", o.align,
      "align the map with the truth on its trees first (for a map without absolute position)");
  add_limited(command, "--align-offset", o.search.offset_max_m, 0.0, 100.0,
              "max offset of the middle of the map [m]; --poses narrows the search")
      ->needs(align);
  add_limited(command, "--align-turn", o.search.turn_max_rad, 0.0, 3.15,
              "max rotation of the map about its middle [rad]")
      ->needs(align);
  command.add_flag("--json", o.json, "print JSON, with lengths in metres");
  command.add_flag(
      "--check", o.check,
      "exit code 1 unless each object is found exactly once with its class, and nothing else");
}

void add_trajectory(CLI::App& evaluate, Run& run) {
  add_command<EvaluateTrajectoryOptions>(
      evaluate, run, "trajectory", "Compare an estimated trajectory with the true one: ATE and RPE",
      "  orchard evaluate trajectory out/drive --truth poses.csv --align\n"
      "  orchard evaluate trajectory out/drive/trajectory.csv --truth track.csv --align \\\n"
      "      --delta 10 --unit m\n"
      "  orchard evaluate trajectory out/drive --truth track.csv --nearest --max-difference 0.02 "
      "--json\n"
      "The figures equal those of evo_ape and evo_rpe (evo 1.x) in the plane; evo draws both "
      "paths\n"
      "from trajectory.tum. The truth may have gaps and\n"
      "may lack headings; it is interpolated to the time of each pose, but not across a gap.\n",
      run_evaluate_trajectory, [](CLI::App& command, EvaluateTrajectoryOptions& o) {
        add_required(command, "trajectory", o.trajectory_path, "FOLDER|CSV",
                     "map folder, or its trajectory.csv");
        add_required(command, "--truth", o.truth_path, "CSV",
                     "true poses: utime_us,x_m,y_m and optionally yaw_rad");
        auto* align = command.add_flag(
            "--align", o.align, "first align the trajectory with the truth by least squares");
        command.add_flag("--align-origin", o.align_origin, "first align the first poses of both")
            ->excludes(align);
        command.add_flag("--nearest", o.nearest,
                         "compare with the true pose nearest in time instead of interpolating");
        command
            .add_option("--max-difference", o.rules.max_difference_s,
                        "max time difference [s] with --nearest")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        command
            .add_option(
                "--gap", o.gap_max_s,
                "min interval of true poses that counts as a gap [s]; 0 = three median intervals")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
        command
            .add_option("--delta", o.rules.delta,
                        "RPE: distance between the two poses of a pair, in --unit")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        using evaluation::DeltaUnit;
        command.add_option("--unit", o.rules.unit, "unit of --delta: m, s or frames")
            ->transform(CLI::CheckedTransformer(
                std::map<std::string, DeltaUnit>{{"m", DeltaUnit::kMetres},
                                                 {"s", DeltaUnit::kSeconds},
                                                 {"frames", DeltaUnit::kFrames}}))
            ->default_str("m");
        command.add_flag("--all-pairs", o.rules.all_pairs,
                         "RPE over all pairs of poses (overlapping) instead of consecutive ones");
        command.add_flag("--json", o.json, "print JSON, in metres and radians");
      });
}

}  // namespace

void add_evaluate(CLI::App& app, Run& run) {
  const char* examples =
      "  orchard evaluate out/drive --truth truth.csv        (short for evaluate map)\n"
      "  orchard evaluate map out/drive/map.csv --truth truth.csv --json > evaluation.json\n"
      "  orchard evaluate out/drive --truth truth.csv --check && echo perfect\n"
      "  orchard evaluate map out/drive --truth truth.csv --poses poses.csv --align\n"
      "  orchard evaluate trajectory out/drive --truth poses.csv --align\n";
  CLI::App& evaluate =
      add_subcommand(app, "evaluate", "Compare a map or a trajectory with the truth", examples);
  const auto options = std::make_shared<EvaluateOptions>();
  add_map_options(evaluate, *options, false);
  on_command(evaluate, [&run, options] {
    if (options->map_path.empty()) throw CLI::RequiredError("map");
    if (options->truth_path.empty()) throw CLI::RequiredError("--truth");
    run = [options] { return run_evaluate(*options); };
  });
  evaluate.require_subcommand(0, 1);
  add_command<EvaluateOptions>(
      evaluate, run, "map",
      "Compare a map with the truth: objects found, classes, position and width errors", examples,
      run_evaluate,
      [](CLI::App& command, EvaluateOptions& o) { add_map_options(command, o, true); });
  add_trajectory(evaluate, run);
}

}  // namespace orchard::cli
