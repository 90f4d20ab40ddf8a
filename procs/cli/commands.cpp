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
      "      --truth out/truth.csv --poses out/poses.csv\n"
      "Output: an LCM log as a robot would record it, and on request the true objects and poses\n"
      "as CSV files for `orchard evaluate`. The same seed gives the same bytes.\n",
      simulate, [](CLI::App& command, SimulateOptions& o) {
        command
            .add_option("--scene", o.scene,
                        "scene: tubes (the paper's), orchard, park, yard, or board (for calibrate "
                        "laser-camera)")
            ->required()
            ->check(CLI::IsMember({"tubes", "orchard", "park", "yard", "board"}));
        command.add_option("--seed", o.seed, "seed of the layout and of all noise")
            ->capture_default_str();
        add_required(command, "--out", o.out_path, "LOG", "log to write");
        add_value(command, "--truth", o.truth_path, "CSV",
                  "also write the true objects (position, width, class)");
        add_value(command, "--poses", o.poses_path, "CSV",
                  "also write the true poses of the robot");
        add_value(command, "--config", o.config_path, "FILE",
                  "configuration of the rig [that of the scene]");
        add_value(command, "--from", o.from_s, "S",
                  "start the log this many seconds into the scene")
            ->check(CLI::NonNegativeNumber);
        add_value(command, "--duration", o.duration_s, "S",
                  "length of the log in seconds; 0 = the whole scene")
            ->check(CLI::NonNegativeNumber);
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
        add_required(command, "source", o.source_paths, "BAG...|FOLDER|RAWLOG|LOG",
                     "bags of one drive (.bag, .mcap, .db3 or a rosbag2 folder), recording "
                     "folder, MRPT rawlog, or LCM log with libbot's types");
        add_required(command, "--out", o.out_path, "LOG", "log to write");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig whose section drivers.bot_core names the channels of a libbot log");
        add_value(command, "--topic", o.topics, "KIND=TOPIC",
                  "topic to read this kind from; none = leave the kind out")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        add_value(command, "--slice-height", o.slice_height_m, "M",
                  "height of the middle of the slice above the origin of the cloud's frame")
            ->check(CLI::Range(-100.0, 100.0))
            ->capture_default_str();
        add_value(command, "--slice-thickness", o.slice_thickness_m, "M",
                  "thickness of the slice of a point cloud")
            ->check(CLI::Range(0.001, 100.0))
            ->capture_default_str();
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
        add_required(command, "log", o.log_paths, "LOG...",
                     "log to map, or the parts of a split log, in any order");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig to use instead of the one in the log; needed for a log without CONFIG");
        add_required(command, "--out", o.out_folder, "DIR",
                     "folder for the map; created if it does not exist");
        add_value(command, "--previous", o.previous_path, "FOLDER|CSV",
                  "map of an earlier drive; landmarks found again keep their id and number");
        add_alignment_options(command, o.previous_alignment);
        command.add_flag("--strict", o.strict, "refuse a damaged log (exit code 3)");
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
        command.add_flag("--no-derived", o.no_derived,
                         "do not write derived.lcm, the log of all intermediate messages (twice "
                         "the size of the input)");
        add_value(command, "--jobs", o.num_jobs, "N",
                  "number of threads; 0 = one per core; the output does not depend on it")
            ->check(CLI::Range(0, 256))
            ->capture_default_str();
        command.add_flag("--timing", o.timing, "print CPU time and memory per thousand scans");
      });
}

void add_log(CLI::App& app, Run& run) {
  CLI::App* log = app.add_subcommand("log", "Inspect, check, repair or convert a log");
  log->require_subcommand(1);
  const auto add_path = [](CLI::App& command, LogOptions& o) {
    add_required(command, "log", o.log_path, "LOG", "log to read");
  };
  const auto add_paths = [](CLI::App& command, LogOptions& o) {
    add_required(command, "log", o.log_paths, "LOG...", "log to read, or the parts of a split log");
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
        add_value(command, "--process", o.process, "NAME", "configuration of this process");
      });
  add_command<LogOptions>(*log, run, "repair",
                          "Copy every readable message of a damaged log to a new log",
                          "  orchard log repair broken.lcm --out repaired.lcm\n", run_log_repair,
                          [&](CLI::App& command, LogOptions& o) {
                            add_path(command, o);
                            add_required(command, "--out", o.out_path, "LOG", "log to write");
                          });
  add_command<LogMcapOptions>(
      *log, run, "mcap", "Convert a log to MCAP, for Foxglove and Lichtblick",
      "  orchard log mcap drive.lcm --map out/drive --out drive.mcap\n"
      "Output: pictures, scans, fixes and transforms, and the map as markers. With --map, poses "
      "and map are\n"
      "those of the finished map; without it, the messages POSE, MAP and DETECTIONS of the log, if "
      "any.\n",
      run_log_mcap, [](CLI::App& command, LogMcapOptions& o) {
        add_required(command, "log", o.log_paths, "LOG...",
                     "log to convert, or the parts of a split log");
        add_value(command, "--map", o.map_path, "FOLDER|CSV", "finished map of this log");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig to use instead of the one in the log; needed for a log without CONFIG");
        add_required(command, "--out", o.out_path, "MCAP", "file to write");
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
        add_required(command, "log", o.log_path, "LOG", "log with SCAN and IMAGE");
        add_required(command, "--at", o.at, "TIME",
                     "seconds since the start of the log, or a utime [us]; draws the nearest "
                     "pair of scan and picture");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig to use instead of the one in the log; needed for a log without CONFIG");
        add_required(command, "--out", o.out_path, "SVG|PNG|PDF", "picture to write");
      });
}

void add_lcm_url(CLI::App& command, std::string& url) {
  add_value(command, "--lcm-url", url, "URL",
            "URL of the LCM network [that of the rig, else $LCM_DEFAULT_URL, else the default]");
}

void add_echo(CLI::App& app, Run& run) {
  add_command<EchoOptions>(
      app, run, "echo", "Print the messages of a channel until Ctrl-C, one per line",
      "  orchard echo DETECTIONS\n"
      "  orchard echo SCAN --count 1 --json\n"
      "  orchard echo STATUS --lcm-url 'udpm://239.255.76.67:7667?ttl=1'\n",
      run_echo, [](CLI::App& command, EchoOptions& o) {
        add_required(command, "channel", o.channel, "CHANNEL",
                     "name of the channel, such as DETECTIONS");
        command.add_flag("--json", o.json, "print one JSON object per message");
        add_value(command, "--count", o.count, "N", "stop after this many messages; 0 = at Ctrl-C")
            ->check(CLI::NonNegativeNumber);
        add_lcm_url(command, o.lcm_url);
        add_value(command, "--config", o.config_path, "FILE", "rig whose LCM network is used");
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
        add_value(command, "--config", o.config_path, "FILE", "rig whose LCM network is used");
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
