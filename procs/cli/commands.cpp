// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.hpp"

#include <CLI/CLI.hpp>
#include <string>

#include "cli/add_command.hpp"
#include "cli/logs/echo.hpp"
#include "cli/logs/import.hpp"
#include "cli/logs/log_commands.hpp"
#include "cli/logs/log_mcap.hpp"
#include "cli/logs/simulate.hpp"
#include "cli/logs/simulate_board.hpp"
#include "cli/maps/map.hpp"
#include "cli/rig/doctor.hpp"
#include "cli/rig/overlay.hpp"

namespace orchard::cli {
namespace {

/// The board scene runs in another program, so that mapping does not need its rendering code.
int simulate(const SimulateOptions& options) {
  return options.scene == "board" ? run_simulate_board(options) : run_simulate(options);
}

void add_simulate(CLI::App& app, Run& run) {
  add_command<SimulateOptions>(
      app, run, "simulate", "Drive through a simulated scene and write the log of it",
      "  orchard simulate --scene tubes --seed 1 --out out/tubes.lcm --truth out/truth.csv\n"
      "  orchard simulate --scene orchard --seed 7 --out out/drive.lcm --duration 60 \\\n"
      "      --truth out/truth.csv --poses out/poses.csv --observations out/looks.csv\n",
      simulate, [](CLI::App& command, SimulateOptions& o) {
        command
            .add_option(
                "--scene", o.scene,
                "tubes (the paper's), orchard, park, yard, or board (for calibrate laser-camera)")
            ->required()
            ->check(CLI::IsMember({"tubes", "orchard", "park", "yard", "board"}));
        command.add_option("--seed", o.seed, "all noise and layout follow from it")
            ->capture_default_str();
        command.add_option("--out", o.out_path, "log to write")->required()->type_name("LOG");
        command.add_option("--truth", o.truth_path, "also write what stands there")
            ->type_name("CSV");
        command.add_option("--poses", o.poses_path, "also write where the robot truly was")
            ->type_name("CSV");
        command
            .add_option("--observations", o.observations_path,
                        "also write what each scan truly held of every thing")
            ->type_name("CSV");
        command.add_option("--config", o.config_path, "rig; without it the scene's own")
            ->type_name("FILE");
        command.add_option("--from", o.from_s, "begin the log that many seconds into the scene")
            ->check(CLI::NonNegativeNumber)
            ->type_name("S");
        command
            .add_option("--duration", o.duration_s, "stop after that many seconds; 0 = whole scene")
            ->check(CLI::NonNegativeNumber)
            ->type_name("S");
      });
}

void add_import(CLI::App& app, Run& run) {
  add_command<ImportOptions>(
      app, run, "import",
      "Turn bags of ROS, a recording folder, a rawlog or a libbot log into a log",
      "  orchard import recordings/drive_1 --out drive_1.lcm     (a folder with sensors.yaml)\n"
      "  orchard import drive.rawlog --out drive.lcm\n"
      "  orchard import lcmlog-2026-05-04.00 --config rig.yaml --out drive.lcm   (libbot's "
      "types)\n"
      "  orchard import drive.bag --out drive.lcm                          (ROS 1)\n"
      "  orchard import drive_0.mcap drive_1.mcap --topic scan=/front/scan --out drive.lcm\n"
      "  orchard import rosbag2_2026_05_04 --topic image=none --out drive.lcm   (ROS 2, a folder)\n"
      "Of bags: the only topic of a type is found by itself; among several --topic chooses. KIND "
      "is\n"
      "scan, scan_rear, image, odometry, imu, gnss or pose_fix. A PointCloud2 becomes a scan by a\n"
      "horizontal slice. What is damaged is passed over and said.\n",
      run_import, [](CLI::App& command, ImportOptions& o) {
        command
            .add_option("source", o.source_paths,
                        "bags of one drive (.bag, .mcap, .db3 or rosbag2's folder), recording "
                        "folder, rawlog, or LCM log of libbot's types")
            ->required()
            ->type_name("BAG...|FOLDER|RAWLOG|LOG");
        command.add_option("--out", o.out_path, "log to write")->required()->type_name("LOG");
        command.add_option("--config", o.config_path, "rig whose drivers.bot_core names channels")
            ->type_name("FILE");
        command
            .add_option("--topic", o.topics, "which topic a kind is taken from; none = leave out")
            ->type_name("KIND=TOPIC")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        command
            .add_option("--slice-height", o.slice_height_m,
                        "middle of a cloud's slice above its frame's origin")
            ->check(CLI::Range(-100.0, 100.0))
            ->capture_default_str()
            ->type_name("M");
        command.add_option("--slice-thickness", o.slice_thickness_m, "of a cloud's slice")
            ->check(CLI::Range(0.001, 100.0))
            ->capture_default_str()
            ->type_name("M");
      });
}

void add_map(CLI::App& app, Run& run) {
  add_command<MapOptions>(
      app, run, "map", "Make the map of a log, in this process and faster than it was driven",
      "  orchard map drive.lcm --out out/drive                  (by the rig in the log)\n"
      "  orchard map drive.lcm.00 drive.lcm.01 --out out/drive  (what lcm-logger split)\n"
      "  orchard map drive.lcm --config mine.yaml --out out/drive --strict --quiet\n"
      "  orchard map later.lcm --previous out/drive --out out/later\n"
      "The map depends on the log and the configuration only: the same files every time.\n"
      "A damaged log is mapped from what can be read, with warnings; --strict refuses it.\n",
      run_map, [](CLI::App& command, MapOptions& o) {
        command.add_option("log", o.log_paths, "log to map, or the pieces of one, in any order")
            ->required()
            ->type_name("LOG...");
        command
            .add_option("--config", o.config_path,
                        "another rig than it was recorded with, or that of a log without CONFIG")
            ->type_name("FILE");
        command.add_option("--out", o.out_folder, "folder for the map, made when missing")
            ->required()
            ->type_name("DIR");
        command
            .add_option("--previous", o.previous_path,
                        "map of an earlier drive: what is found again keeps its id and number")
            ->type_name("FOLDER|CSV");
        add_alignment_options(command, o.previous_alignment);
        command.add_flag("--strict", o.strict, "refuse a log with any damage (exit 3)");
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
        command.add_flag("--no-derived", o.no_derived,
                         "leave out derived.lcm, the messages on the way (twice the log's size)");
        command
            .add_option("--jobs", o.num_jobs,
                        "threads that work at once, 0 = one for each core; the same files")
            ->check(CLI::Range(0, 256))
            ->capture_default_str()
            ->type_name("N");
        command.add_flag("--timing", o.timing,
                         "print processor time and memory for every thousand scans");
      });
}

void add_log(CLI::App& app, Run& run) {
  CLI::App* log = app.add_subcommand("log", "Look into a log: what it holds, its rig, its damage");
  log->require_subcommand(1);
  const auto add_path = [](CLI::App& command, LogOptions& o) {
    command.add_option("log", o.log_path, "log to read")->required()->type_name("LOG");
  };
  const auto add_paths = [](CLI::App& command, LogOptions& o) {
    command.add_option("log", o.log_paths, "log to read, or the pieces of one")
        ->required()
        ->type_name("LOG...");
    command.add_flag("--json", o.json, "for programs");
  };
  const auto add_survey = [add_path](CLI::App& command, LogOptions& o) {
    add_path(command, o);
    command.add_flag("--json", o.json, "for programs");
  };
  add_command<LogOptions>(*log, run, "info", "What it holds: channels, counts, rates, times",
                          "  orchard log info drive.lcm\n"
                          "  orchard log info drive.lcm.00 drive.lcm.01 --json\n",
                          run_log_info, add_paths);
  add_command<LogOptions>(*log, run, "check", "What is wrong with it; exit 3 when something is",
                          "  orchard log check drive.lcm && echo sound\n", run_log_check,
                          add_survey);
  add_command<LogOptions>(
      *log, run, "config", "Print the rig that it was recorded with, as YAML for --config",
      "  orchard log config drive.lcm > mine.yaml\n"
      "  orchard log config drive.lcm --process orchard-detector     (where processes differ)\n",
      run_log_config, [&](CLI::App& command, LogOptions& o) {
        add_path(command, o);
        command.add_option("--process", o.process, "the one that this process ran with")
            ->type_name("NAME");
      });
  add_command<LogOptions>(
      *log, run, "repair", "Write a new log of every message that can be read",
      "  orchard log repair broken.lcm --out repaired.lcm\n", run_log_repair,
      [&](CLI::App& command, LogOptions& o) {
        add_path(command, o);
        command.add_option("--out", o.out_path, "log to write")->required()->type_name("LOG");
      });
  add_command<LogMcapOptions>(
      *log, run, "mcap", "Write it as MCAP, for Foxglove and Lichtblick",
      "  orchard log mcap drive.lcm --map out/drive --out drive.mcap\n"
      "Pictures, scans, fixes, transforms and the map as markers. With --map the finished map and\n"
      "its path; without it what the log itself holds of POSE, MAP and DETECTIONS.\n",
      run_log_mcap, [](CLI::App& command, LogMcapOptions& o) {
        command.add_option("log", o.log_paths, "log to write, or the pieces of one")
            ->required()
            ->type_name("LOG...");
        command.add_option("--map", o.map_path, "the map that was made of it")
            ->type_name("FOLDER|CSV");
        command
            .add_option("--config", o.config_path,
                        "another rig than it was recorded with, or that of a log without CONFIG")
            ->type_name("FILE");
        command.add_option("--out", o.out_path, "file to write")->required()->type_name("MCAP");
      });
  log->footer(
      "Examples:\n  orchard log info drive.lcm\n  orchard log check drive.lcm\n"
      "  orchard log repair broken.lcm --out repaired.lcm\n");
}

void add_overlay(CLI::App& app, Run& run) {
  add_command<OverlayOptions>(
      app, run, "overlay", "Draw what laser and detector see onto a log's picture",
      "  orchard overlay drive.lcm --at 12.5 --out overlay.png          (by the rig in the log)\n"
      "  orchard overlay drive.lcm --at 1385942412500000 --config mine.yaml --out overlay.png\n"
      "Scan points by range (red near, blue far), colour windows (white), edge windows (grey) "
      "with\n"
      "the columns the laser expects (ticks) and the edges found (cyan), confidences below.\n",
      run_overlay, [](CLI::App& command, OverlayOptions& o) {
        command.add_option("log", o.log_path, "log with SCAN and IMAGE")
            ->required()
            ->type_name("LOG");
        command
            .add_option("--at", o.at,
                        "seconds from the log's start, or a utime [us]; the nearest pair is drawn")
            ->required()
            ->type_name("TIME");
        command
            .add_option("--config", o.config_path,
                        "another rig than it was recorded with, or that of a log without CONFIG")
            ->type_name("FILE");
        command.add_option("--out", o.out_path, "picture to write")
            ->required()
            ->type_name("SVG|PNG|PDF");
      });
}

void add_lcm_url(CLI::App& command, std::string& url) {
  command
      .add_option("--lcm-url", url,
                  "LCM network (without: the rig's, then $LCM_DEFAULT_URL, then the default)")
      ->type_name("URL");
}

void add_echo(CLI::App& app, Run& run) {
  add_command<EchoOptions>(
      app, run, "echo", "Print the messages of a channel until Ctrl-C, one per line",
      "  orchard echo DETECTIONS\n"
      "  orchard echo SCAN --count 1 --json\n"
      "  orchard echo STATUS --lcm-url 'udpm://239.255.76.67:7667?ttl=1'\n",
      run_echo, [](CLI::App& command, EchoOptions& o) {
        command.add_option("channel", o.channel, "as on the wire")
            ->required()
            ->type_name("CHANNEL");
        command.add_flag("--json", o.json, "one JSON object per line");
        command.add_option("--count", o.count, "end after so many messages; 0 = until Ctrl-C")
            ->check(CLI::NonNegativeNumber)
            ->type_name("N");
        add_lcm_url(command, o.lcm_url);
        command.add_option("--config", o.config_path, "the rig's YAML")->type_name("FILE");
      });
}

void add_doctor(CLI::App& app, Run& run) {
  add_command<DoctorOptions>(
      app, run, "doctor", "Check what LCM needs of this machine, and say how to mend it",
      "  orchard doctor\n"
      "  orchard doctor --lcm-url 'udpm://239.255.76.67:7667?ttl=1'     (several machines)\n"
      "Exit code 1 when something keeps messages from flowing.\n",
      run_doctor, [](CLI::App& command, DoctorOptions& o) {
        add_lcm_url(command, o.lcm_url);
        command.add_option("--config", o.config_path, "the rig's YAML")->type_name("FILE");
        command.add_flag("--json", o.json, "for programs");
      });
}

}  // namespace

void add_all_commands(CLI::App& app, Run& run) {
  add_simulate(app, run);
  add_import(app, run);
  add_map(app, run);
  add_evaluate(app, run);
  add_compare(app, run);
  add_merge(app, run);
  add_view(app, run);
  add_growers(app, run);
  add_plan(app, run);
  add_report(app, run);
  add_publish(app, run);
  add_export(app, run);
  add_import_edits(app, run);
  add_overlay(app, run);
  add_log(app, run);
  add_field(app, run);
  add_farm(app, run);
  add_echo(app, run);
  add_doctor(app, run);
  add_calibrate(app, run);
}

}  // namespace orchard::cli
