// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "bus/node/process_options.hpp"
#include "cli/add_command.hpp"
#include "cli/field/field.hpp"
#include "cli/logs/logs.hpp"
#include "cli/maps/maps.hpp"
#include "cli/rig/learn.hpp"

namespace orchard::cli {
namespace {

void add_map_options(CLI::App& command, EvaluateOptions& o, bool required) {
  add_value(command, "map", o.map_path, "FOLDER|CSV")->required(required);
  add_value(command, "--truth", o.truth_path, "CSV")->required(required);
  add_value(command, "--poses", o.poses_path, "CSV");
  add_limited(command, "--gate", o.gate_m, 0.001, 100.0);
  auto* align = command.add_flag("--align", o.align);
  add_limited(command, "--align-offset", o.search.offset_max_m, 0.0, 100.0)->needs(align);
  add_limited(command, "--align-turn", o.search.turn_max_rad, 0.0, 3.15)->needs(align);
  command.add_flag("--json", o.json);
  command.add_flag("--check", o.check);
}

void declare(CLI::App& command, EvaluateTrajectoryOptions& o) {
  add_required(command, "trajectory", o.trajectory_path, "FOLDER|CSV");
  add_required(command, "--truth", o.truth_path, "CSV");
  add_value(command, "--rows", o.rows_path, "FOLDER|FILE");
  auto* align = command.add_flag("--align", o.align);
  command.add_flag("--align-origin", o.align_origin)->excludes(align);
  add_checked(command, "--gap", o.gap_max_s, CLI::NonNegativeNumber);
  add_checked(command, "--delta", o.rules.delta_m, CLI::PositiveNumber);
  command.add_flag("--json", o.json);
}

void declare(CLI::App& command, EvaluateLocalisationOptions& o) {
  add_required(command, "log", o.log_paths, "LOG...");
  add_value(command, "--map", o.map_path, "FOLDER|FILE");
  add_value(command, "--config", o.config_path, "FILE");
  add_value(command, "--truth", o.truth_path, "CSV");
  add_limited(command, "--truth-sd", o.truth_sd_m, 0.0, 10.0);
  command.add_flag("--start-known", o.start_known);
  add_value(command, "--out", o.out_folder, "DIR");
  command.add_flag("--quiet", o.quiet);
  command.add_flag("--json", o.json);
}

void declare(CLI::App& command, EvaluateOptions& o) { add_map_options(command, o, true); }

void add_evaluate(CLI::App& app, Run& run) {
  CLI::App& evaluate = add_subcommand(app, "evaluate");
  const auto options = std::make_shared<EvaluateOptions>();
  add_map_options(evaluate, *options, false);
  add_version(evaluate);
  on_command(evaluate, [&run, &evaluate, options] {
    if (options->map_path.empty()) throw CLI::RequiredError("map");
    if (options->truth_path.empty()) throw CLI::RequiredError("--truth");
    run = [&evaluate, options] { return run_command(evaluate, run_evaluate, *options); };
  });
  evaluate.require_subcommand(0, 1);
  add_command(evaluate, run, "map", run_evaluate, declare);
  add_command(evaluate, run, "trajectory", run_evaluate_trajectory, declare);
  add_command(evaluate, run, "localisation", run_evaluate_localisation, declare);
}

void add_network(CLI::App& command, FieldOptions& o) {
  bus::add_network_options(command, o);
  add_value(command, "--config", o.config_path, "FILE");
}

void declare(CLI::App& command, LiveOptions& o) {
  add_required(command, "rig", o.config_path, "RIG");
  add_value(command, "--out", o.out_folder, "DIR");
  add_value(command, "--record", o.record_folder, "DIR");
  add_value(command, "--only", o.only, "NAMES")->delimiter(',');
  add_value(command, "--without", o.without, "NAMES")->delimiter(',');
  command.add_option("--sim", o.scene)->check(CLI::IsMember({"tubes", "orchard", "park"}));
  add_value(command, "--emulate", o.played_log, "LOG")->excludes("--sim");
  command.add_flag("--edit", o.edit);
  add_shown(command, "--seed", o.seed);
  add_shown(command, "--speed", o.speed);
  bus::add_network_options(command, o);
}

void declare(CLI::App& command, StatusOptions& o) {
  add_network(command, o);
  command.add_flag("--once", o.once);
  command.add_flag("--json", o.json);
}

void declare(CLI::App& command, RecordOptions& o) {
  add_value(command, "--out", o.folder, "DIR")->capture_default_str();
  add_value(command, "--name", o.name, "NAME")->capture_default_str();
  add_limited(command, "--split-mb", o.split_mb, 1.0, 1e6);
  add_checked(command, "--keep-gb", o.keep_gb, CLI::NonNegativeNumber);
  add_network(command, o);
}

/// The board scene is in another program, so that mapping does not need its rendering code.
int simulate(const SimulateOptions& options) {
  const bool is_board = options.scene == "board";
  const auto function = is_board ? run_simulate_board : run_simulate;
  if (function == nullptr) replace_by_program(is_board ? "orchard-calibrate" : "orchard");
  return function(options);
}

void declare(CLI::App& command, SimulateOptions& o) {
  command.add_option("--scene", o.scene)
      ->required()
      ->check(CLI::IsMember({"tubes", "orchard", "park", "yard", "board"}));
  add_shown(command, "--seed", o.seed);
  add_required(command, "--out", o.out_path, "LOG");
  add_value(command, "--truth", o.truth_path, "CSV");
  add_value(command, "--poses", o.poses_path, "CSV");
  add_value(command, "--config", o.config_path, "FILE");
  add_value(command, "--from", o.from_s, "S")->check(CLI::NonNegativeNumber);
  add_value(command, "--duration", o.duration_s, "S")->check(CLI::NonNegativeNumber);
}

void declare(CLI::App& command, ImportOptions& o) {
  add_required(command, "source", o.source_paths, "BAG...|FOLDER|RAWLOG|LOG");
  add_required(command, "--out", o.out_path, "LOG");
  add_value(command, "--config", o.config_path, "FILE");
  add_value(command, "--rig-out", o.rig_out_path, "FILE");
  add_value(command, "--topic", o.topics, "KIND=TOPIC")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_value(command, "--slice-height", o.slice_height_m, "M")
      ->check(CLI::Range(-100.0, 100.0))
      ->capture_default_str();
  add_value(command, "--slice-thickness", o.slice_thickness_m, "M")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
}

void declare(CLI::App& command, MapOptions& o) {
  add_required(command, "log", o.log_paths, "LOG...");
  add_value(command, "--config", o.config_path, "FILE");
  add_required(command, "--out", o.out_folder, "DIR");
  add_value(command, "--previous", o.previous_path, "FOLDER|CSV");
  add_alignment_options(command, o.previous_alignment);
  command.add_flag("--strict", o.strict);
  command.add_flag("--quiet", o.quiet);
  command.add_flag("--no-derived", o.no_derived);
  add_value(command, "--jobs", o.num_jobs, "N")->check(CLI::Range(0, 256))->capture_default_str();
  command.add_flag("--timing", o.timing);
}

void add_path(CLI::App& command, LogOptions& o) { add_required(command, "log", o.log_path, "LOG"); }

void add_paths(CLI::App& command, LogOptions& o) {
  add_required(command, "log", o.log_paths, "LOG...");
}

void declare_survey(CLI::App& command, LogOptions& o) {
  add_paths(command, o);
  command.add_flag("--json", o.json);
}

void declare_config(CLI::App& command, LogOptions& o) {
  add_path(command, o);
  add_value(command, "--process", o.process, "NAME");
}

void declare_repair(CLI::App& command, LogOptions& o) {
  add_path(command, o);
  add_required(command, "--out", o.out_path, "LOG");
}

void declare_split(CLI::App& command, LogOptions& o) {
  add_paths(command, o);
  add_required(command, "--out", o.out_path, "DIR");
}

void declare(CLI::App& command, LogMcapOptions& o) {
  add_required(command, "log", o.log_paths, "LOG...");
  add_value(command, "--map", o.map_path, "FOLDER|CSV");
  add_value(command, "--config", o.config_path, "FILE");
  add_required(command, "--out", o.out_path, "MCAP");
}

void add_log(CLI::App& app, Run& run) {
  CLI::App& log = add_group(app, "log");
  add_command(log, run, "info", run_log_info, declare_survey);
  add_command(log, run, "check", run_log_check, declare_survey);
  add_command(log, run, "config", run_log_config, declare_config);
  add_command(log, run, "repair", run_log_repair, declare_repair);
  add_command(log, run, "split", run_log_split, declare_split);
  add_command(log, run, "mcap", run_log_mcap, declare);
}

void declare(CLI::App& command, OverlayOptions& o) {
  add_required(command, "log", o.log_path, "LOG");
  add_required(command, "--at", o.at, "TIME");
  add_value(command, "--config", o.config_path, "FILE");
  add_required(command, "--out", o.out_path, "SVG|PNG|PDF");
}

void declare(CLI::App& command, EchoOptions& o) {
  add_required(command, "channel", o.channel, "CHANNEL");
  command.add_flag("--json", o.json);
  add_value(command, "--count", o.count, "N")->check(CLI::NonNegativeNumber);
  add_network(command, o);
}

void declare(CLI::App& command, LearnOptions& o) {
  add_required(command, "logs", o.log_paths, "LOG...");
  add_value(command, "--config", o.config_path, "FILE");
  add_required(command, "--out", o.out_path, "RIG");
  command.add_flag("--quiet", o.quiet);
}

void declare(CLI::App& command, DoctorOptions& o) {
  add_network(command, o);
  command.add_flag("--json", o.json);
}

}  // namespace

void add_all_commands(CLI::App& app, Run& run) {
  add_command(app, run, "simulate", simulate, declare);
  add_command(app, run, "import", run_import, declare);
  add_command(app, run, "map", run_map, declare);
  add_evaluate(app, run);
  add_map_commands(app, run);
  add_command(app, run, "overlay", run_overlay, declare);
  add_log(app, run);
  add_command(app, run, "live", run_live, declare);
  add_command(app, run, "status", run_status, declare);
  add_command(app, run, "record", run_record, declare);
  add_farm(app, run);
  add_command(app, run, "echo", run_echo, declare);
  add_command(app, run, "doctor", run_doctor, declare);
  add_command(app, run, "learn", run_learn, declare);
  add_calibrate(app, run);
}

}  // namespace orchard::cli
