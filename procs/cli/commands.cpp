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
      app, run, "simulate", "Simulate a drive through a scene and write its log",
      "  orchard simulate --scene tubes --seed 1 --out out/tubes.lcm --truth out/truth.csv\n"
      "  orchard simulate --scene orchard --seed 7 --out out/drive.lcm --duration 60 \\\n"
      "      --truth out/truth.csv --poses out/poses.csv --observations out/observations.csv\n"
      "Output: an LCM log as a robot would record it, and on request the true objects, poses and\n"
      "observations as CSV files for `orchard evaluate`. The same seed gives the same bytes.\n",
      simulate, [](CLI::App& command, SimulateOptions& o) {
        command
            .add_option("--scene", o.scene,
                        "scene: tubes (the paper's), orchard, park, yard, or board (for calibrate "
                        "laser-camera)")
            ->required()
            ->check(CLI::IsMember({"tubes", "orchard", "park", "yard", "board"}));
        command.add_option("--seed", o.seed, "seed of the layout and of all noise")
            ->capture_default_str();
        command.add_option("--out", o.out_path, "log to write")->required()->type_name("LOG");
        command
            .add_option("--truth", o.truth_path,
                        "also write the true objects (position, width, class)")
            ->type_name("CSV");
        command.add_option("--poses", o.poses_path, "also write the true poses of the robot")
            ->type_name("CSV");
        command
            .add_option("--observations", o.observations_path,
                        "also write the objects that each scan observes, with range and occlusion")
            ->type_name("CSV");
        command
            .add_option("--config", o.config_path, "configuration of the rig [that of the scene]")
            ->type_name("FILE");
        command.add_option("--from", o.from_s, "start the log this many seconds into the scene")
            ->check(CLI::NonNegativeNumber)
            ->type_name("S");
        command
            .add_option("--duration", o.duration_s,
                        "length of the log in seconds; 0 = the whole scene")
            ->check(CLI::NonNegativeNumber)
            ->type_name("S");
      });
}

void add_import(CLI::App& app, Run& run) {
  add_command<ImportOptions>(
      app, run, "import", "Import a ROS bag, recording folder, MRPT rawlog or libbot log as a log",
      "  orchard import recordings/drive_1 --out drive_1.lcm     (a folder with sensors.yaml)\n"
      "  orchard import drive.rawlog --out drive.lcm\n"
      "  orchard import lcmlog-2026-05-04.00 --config rig.yaml --out drive.lcm   (libbot's types)\n"
      "  orchard import drive.bag --out drive.lcm                          (ROS 1)\n"
      "  orchard import drive_0.mcap drive_1.mcap --topic scan=/front/scan --out drive.lcm\n"
      "  orchard import rosbag2_2026_05_04 --topic image=none --out drive.lcm   (ROS 2, a folder)\n"
      "Output: an LCM log for `orchard map`. Of a bag, the topic of each kind is found by its "
      "type;\n"
      "with several topics of a type, choose one by --topic. KIND is scan, scan_rear, image, "
      "odometry,\n"
      "imu, gnss or pose_fix. A PointCloud2 is cut into a scan by a horizontal slice. Damaged "
      "parts are\n"
      "skipped and reported.\n",
      run_import, [](CLI::App& command, ImportOptions& o) {
        command
            .add_option("source", o.source_paths,
                        "bags of one drive (.bag, .mcap, .db3 or a rosbag2 folder), recording "
                        "folder, MRPT rawlog, or LCM log with libbot's types")
            ->required()
            ->type_name("BAG...|FOLDER|RAWLOG|LOG");
        command.add_option("--out", o.out_path, "log to write")->required()->type_name("LOG");
        command
            .add_option("--config", o.config_path,
                        "rig whose section drivers.bot_core names the channels of a libbot log")
            ->type_name("FILE");
        command
            .add_option("--topic", o.topics,
                        "topic to read this kind from; none = leave the kind out")
            ->type_name("KIND=TOPIC")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        command
            .add_option("--slice-height", o.slice_height_m,
                        "height of the middle of the slice above the origin of the cloud's frame")
            ->check(CLI::Range(-100.0, 100.0))
            ->capture_default_str()
            ->type_name("M");
        command
            .add_option("--slice-thickness", o.slice_thickness_m,
                        "thickness of the slice of a point cloud")
            ->check(CLI::Range(0.001, 100.0))
            ->capture_default_str()
            ->type_name("M");
      });
}

void add_map(CLI::App& app, Run& run) {
  add_command<MapOptions>(
      app, run, "map", "Map the log of a drive, faster than real time",
      "  orchard map drive.lcm --out out/drive                  (with the rig stored in the log)\n"
      "  orchard map drive.lcm.00 drive.lcm.01 --out out/drive  (a log that lcm-logger split)\n"
      "  orchard map drive.lcm --config mine.yaml --out out/drive --strict --quiet\n"
      "  orchard map later.lcm --previous out/drive --out out/later\n"
      "Input: a log with SCAN, and what pose.mode needs. Output: a folder with the map as table, "
      "picture,\n"
      "web page and GIS layers, the trajectory and summary.json. The map depends only on the log "
      "and the\n"
      "configuration: the same input gives the same files. Of a damaged log the readable part is "
      "mapped,\n"
      "with warnings; --strict refuses it.\n",
      run_map, [](CLI::App& command, MapOptions& o) {
        command
            .add_option("log", o.log_paths, "log to map, or the parts of a split log, in any order")
            ->required()
            ->type_name("LOG...");
        command
            .add_option("--config", o.config_path,
                        "rig to use instead of the one in the log; needed for a log without CONFIG")
            ->type_name("FILE");
        command
            .add_option("--out", o.out_folder, "folder for the map; created if it does not exist")
            ->required()
            ->type_name("DIR");
        command
            .add_option("--previous", o.previous_path,
                        "map of an earlier drive; landmarks found again keep their id and number")
            ->type_name("FOLDER|CSV");
        add_alignment_options(command, o.previous_alignment);
        command.add_flag("--strict", o.strict, "refuse a damaged log (exit code 3)");
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
        command.add_flag("--no-derived", o.no_derived,
                         "do not write derived.lcm, the log of all intermediate messages (twice "
                         "the size of the input)");
        command
            .add_option("--jobs", o.num_jobs,
                        "number of threads; 0 = one per core; the output does not depend on it")
            ->check(CLI::Range(0, 256))
            ->capture_default_str()
            ->type_name("N");
        command.add_flag("--timing", o.timing, "print CPU time and memory per thousand scans");
      });
}

void add_log(CLI::App& app, Run& run) {
  CLI::App* log = app.add_subcommand("log", "Inspect, check, repair or convert a log");
  log->require_subcommand(1);
  const auto add_path = [](CLI::App& command, LogOptions& o) {
    command.add_option("log", o.log_path, "log to read")->required()->type_name("LOG");
  };
  const auto add_paths = [](CLI::App& command, LogOptions& o) {
    command.add_option("log", o.log_paths, "log to read, or the parts of a split log")
        ->required()
        ->type_name("LOG...");
    command.add_flag("--json", o.json, "print JSON");
  };
  const auto add_survey = [add_path](CLI::App& command, LogOptions& o) {
    add_path(command, o);
    command.add_flag("--json", o.json, "print JSON");
  };
  add_command<LogOptions>(*log, run, "info",
                          "List the channels of a log with counts, rates and times",
                          "  orchard log info drive.lcm\n"
                          "  orchard log info drive.lcm.00 drive.lcm.01 --json\n",
                          run_log_info, add_paths);
  add_command<LogOptions>(
      *log, run, "check", "Check a log for damage; exit code 3 if there is any",
      "  orchard log check drive.lcm && echo sound\n"
      "Reports unreadable bytes, invalid messages, missing sequence numbers and jumps of clocks.\n",
      run_log_check, add_survey);
  add_command<LogOptions>(
      *log, run, "config", "Print the configuration stored in a log, as YAML for --config",
      "  orchard log config drive.lcm > mine.yaml\n"
      "  orchard log config drive.lcm --process orchard-detector     (where processes differ)\n",
      run_log_config, [&](CLI::App& command, LogOptions& o) {
        add_path(command, o);
        command.add_option("--process", o.process, "configuration of this process")
            ->type_name("NAME");
      });
  add_command<LogOptions>(
      *log, run, "repair", "Copy every readable message of a damaged log to a new log",
      "  orchard log repair broken.lcm --out repaired.lcm\n", run_log_repair,
      [&](CLI::App& command, LogOptions& o) {
        add_path(command, o);
        command.add_option("--out", o.out_path, "log to write")->required()->type_name("LOG");
      });
  add_command<LogMcapOptions>(
      *log, run, "mcap", "Convert a log to MCAP, for Foxglove and Lichtblick",
      "  orchard log mcap drive.lcm --map out/drive --out drive.mcap\n"
      "Output: pictures, scans, fixes and transforms, and the map as markers. With --map, poses "
      "and map are\n"
      "those of the finished map; without it, the messages POSE, MAP and DETECTIONS of the log, if "
      "any.\n",
      run_log_mcap, [](CLI::App& command, LogMcapOptions& o) {
        command.add_option("log", o.log_paths, "log to convert, or the parts of a split log")
            ->required()
            ->type_name("LOG...");
        command.add_option("--map", o.map_path, "finished map of this log")
            ->type_name("FOLDER|CSV");
        command
            .add_option("--config", o.config_path,
                        "rig to use instead of the one in the log; needed for a log without CONFIG")
            ->type_name("FILE");
        command.add_option("--out", o.out_path, "file to write")->required()->type_name("MCAP");
      });
  log->footer(
      "Examples:\n  orchard log info drive.lcm\n  orchard log check drive.lcm\n"
      "  orchard log repair broken.lcm --out repaired.lcm\n");
}

void add_overlay(CLI::App& app, Run& run) {
  add_command<OverlayOptions>(
      app, run, "overlay", "Draw laser points and detections onto a picture of a log",
      "  orchard overlay drive.lcm --at 12.5 --out overlay.png          (with the rig stored in "
      "the log)\n"
      "  orchard overlay drive.lcm --at 1385942412500000 --config mine.yaml --out overlay.png\n"
      "Shows the scan points coloured by range (red near, blue far), the colour windows (white), "
      "the edge\n"
      "windows (grey) with the edge columns that the laser predicts (ticks), the edges found "
      "(cyan), and\n"
      "the confidences (below).\n",
      run_overlay, [](CLI::App& command, OverlayOptions& o) {
        command.add_option("log", o.log_path, "log with SCAN and IMAGE")
            ->required()
            ->type_name("LOG");
        command
            .add_option("--at", o.at,
                        "seconds since the start of the log, or a utime [us]; draws the nearest "
                        "pair of scan and picture")
            ->required()
            ->type_name("TIME");
        command
            .add_option("--config", o.config_path,
                        "rig to use instead of the one in the log; needed for a log without CONFIG")
            ->type_name("FILE");
        command.add_option("--out", o.out_path, "picture to write")
            ->required()
            ->type_name("SVG|PNG|PDF");
      });
}

void add_lcm_url(CLI::App& command, std::string& url) {
  command
      .add_option(
          "--lcm-url", url,
          "URL of the LCM network [that of the rig, else $LCM_DEFAULT_URL, else the default]")
      ->type_name("URL");
}

void add_echo(CLI::App& app, Run& run) {
  add_command<EchoOptions>(
      app, run, "echo", "Print the messages of a channel until Ctrl-C, one per line",
      "  orchard echo DETECTIONS\n"
      "  orchard echo SCAN --count 1 --json\n"
      "  orchard echo STATUS --lcm-url 'udpm://239.255.76.67:7667?ttl=1'\n",
      run_echo, [](CLI::App& command, EchoOptions& o) {
        command.add_option("channel", o.channel, "name of the channel, such as DETECTIONS")
            ->required()
            ->type_name("CHANNEL");
        command.add_flag("--json", o.json, "print one JSON object per message");
        command.add_option("--count", o.count, "stop after this many messages; 0 = at Ctrl-C")
            ->check(CLI::NonNegativeNumber)
            ->type_name("N");
        add_lcm_url(command, o.lcm_url);
        command.add_option("--config", o.config_path, "rig whose LCM network is used")
            ->type_name("FILE");
      });
}

void add_doctor(CLI::App& app, Run& run) {
  add_command<DoctorOptions>(
      app, run, "doctor", "Check this machine's network for LCM and print a fix for each problem",
      "  orchard doctor\n"
      "  orchard doctor --lcm-url 'udpm://239.255.76.67:7667?ttl=1'     (several machines)\n"
      "Tests routes, buffers, firewall and a message to itself, and lists the running processes of "
      "Orchard\n"
      "Mapper and clocks that differ. Exit code 1 if messages cannot get through.\n",
      run_doctor, [](CLI::App& command, DoctorOptions& o) {
        add_lcm_url(command, o.lcm_url);
        command.add_option("--config", o.config_path, "rig whose LCM network is used")
            ->type_name("FILE");
        command.add_flag("--json", o.json, "print JSON");
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
