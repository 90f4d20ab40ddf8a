// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <string>

#include "cli/add_command.hpp"
#include "cli/evaluate.hpp"

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
  command.add_flag("--json", o.json, "for programs; lengths in metres");
  command.add_flag("--check", o.check,
                   "exit 1 unless all is found once, with its class, and nothing else");
}

}  // namespace

void add_evaluate(CLI::App& app, Run& run) {
  const char* examples =
      "  orchard evaluate out/drive --truth truth.csv        (evaluate map, in short)\n"
      "  orchard evaluate map out/drive/map.csv --truth truth.csv --json > evaluation.json\n"
      "  orchard evaluate out/drive --truth truth.csv --check && echo perfect\n";
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
}

}  // namespace orchard::cli
