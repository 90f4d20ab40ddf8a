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
      evaluate, run, "trajectory",
      "Compare an estimated trajectory with the true one: ATE, RPE, cross-track error, right aisle",
      "  orchard evaluate trajectory out/drive --truth poses.csv --align\n"
      "  orchard evaluate trajectory out/drive/trajectory.csv --truth track.csv --align \\\n"
      "      --delta 10 --unit m\n"
      "  orchard evaluate trajectory out/drive --truth track.csv --nearest --max-difference 0.02 "
      "--json\n"
      "  orchard evaluate trajectory out/drive --truth track.csv --rows survey.csv\n"
      "The figures equal those of evo_ape and evo_rpe (evo 1.x) in the plane; evo draws both\n"
      "paths from trajectory.tum. The truth may have gaps and may lack headings; it is\n"
      "interpolated to the time of each pose, but not across a gap. Nothing is aligned unless\n"
      "asked: a pose in a given map is right or wrong as it is. With --rows: the error across the\n"
      "rows, and the share of poses in the right aisle.\n",
      run_evaluate_trajectory, [](CLI::App& command, EvaluateTrajectoryOptions& o) {
        add_required(command, "trajectory", o.trajectory_path, "FOLDER|CSV",
                     "map folder, or its trajectory.csv");
        add_required(command, "--truth", o.truth_path, "CSV",
                     "true poses: utime_us,x_m,y_m and optionally yaw_rad");
        add_value(command, "--rows", o.rows_path, "FOLDER|FILE",
                  "map, or survey (CSV, GeoJSON ...) of the rows, in the frame of --truth: also "
                  "evaluate cross-track error and aisle");
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

void add_localisation(CLI::App& evaluate, Run& run) {
  add_command<EvaluateLocalisationOptions>(
      evaluate, run, "localisation",
      "Locate a drive in a map as if it had no satellite receiver, and compare with its fixes",
      "  orchard evaluate localisation drive.lcm --map out/spring\n"
      "  orchard evaluate localisation drive.lcm --map survey.geojson --truth rtk.csv \\\n"
      "      --config my_robot.yaml --out out/shadow\n"
      "Runs pose.mode prior_map beside the truth, which it does not use: how long and how far the\n"
      "robot could have driven by it within 0.1, 0.3 and 0.5 m, when it was LOST or AMBIGUOUS, "
      "when\n"
      "it was wrong without a warning, and whether its claimed errors are true. Nothing is\n"
      "aligned: the truth must be in the frame of the map.\n",
      run_evaluate_localisation, [](CLI::App& command, EvaluateLocalisationOptions& o) {
        add_required(command, "log", o.log_paths, "LOG...", "a log, or the parts of a split log");
        add_value(
            command, "--map", o.map_path, "FOLDER|FILE",
            "map folder, map.csv or survey to locate in [pose.prior_map.map_file of the rig]");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig to use instead of the one in the log");
        add_value(command, "--truth", o.truth_path, "CSV",
                  "true poses: utime_us,x_m,y_m and optionally yaw_rad [POSE_FIX of the log]");
        add_limited(command, "--truth-sd", o.truth_sd_m, 0.0, 10.0,
                    "standard deviation of the true positions [m]");
        command.add_flag("--start-known", o.start_known,
                         "start at the first true pose, like a robot that leaves its dock, instead "
                         "of searching the whole map");
        add_value(command, "--out", o.out_folder, "DIR",
                  "folder for localisation.csv, localisation.png (error and claim over time) and "
                  "trajectory.csv");
        command.add_flag("--quiet", o.quiet, "no progress bar");
        command.add_flag("--json", o.json, "print JSON, in metres, seconds and radians");
      });
}

void add_evaluate(CLI::App& app, Run& run) {
  const char* examples =
      "  orchard evaluate out/drive --truth truth.csv        (short for evaluate map)\n"
      "  orchard evaluate map out/drive/map.csv --truth truth.csv --json > evaluation.json\n"
      "  orchard evaluate out/drive --truth truth.csv --check && echo perfect\n"
      "  orchard evaluate map out/drive --truth truth.csv --poses poses.csv --align\n"
      "  orchard evaluate trajectory out/drive --truth poses.csv --align\n"
      "  orchard evaluate localisation drive.lcm --map out/spring\n";
  CLI::App& evaluate =
      add_subcommand(app, "evaluate", "Compare a map or a trajectory with the truth", examples);
  const auto options = std::make_shared<EvaluateOptions>();
  add_map_options(evaluate, *options, false);
  on_command(evaluate, [&run, &evaluate, options] {
    if (options->map_path.empty()) throw CLI::RequiredError("map");
    if (options->truth_path.empty()) throw CLI::RequiredError("--truth");
    run = [&evaluate, options] { return run_command(evaluate, run_evaluate, *options); };
  });
  evaluate.require_subcommand(0, 1);
  add_command<EvaluateOptions>(
      evaluate, run, "map",
      "Compare a map with the truth: objects found, classes, position and width errors", examples,
      run_evaluate,
      [](CLI::App& command, EvaluateOptions& o) { add_map_options(command, o, true); });
  add_trajectory(evaluate, run);
  add_localisation(evaluate, run);
}

void add_rig(CLI::App& command, std::string& config_path) {
  add_value(command, "--config", config_path, "FILE", "rig to use instead of the one in the log");
}

void add_network(CLI::App& command, FieldOptions& o) {
  bus::add_network_options(command, o);
  add_value(command, "--config", o.config_path, "FILE", "rig whose LCM network is used");
}

void add_live(CLI::App& app, Run& run) {
  add_command<LiveOptions>(
      app, run, "live", "Run all processes of this machine until Ctrl-C",
      "  orchard live my_robot.yaml --record out/recordings\n"
      "  orchard live config/orchard.yaml --sim orchard --seed 7     (without hardware)\n"
      "  orchard live my_robot.yaml --emulate drive.lcm              (drivers without their "
      "devices)\n"
      "  orchard live my_robot.yaml --only drivers                   (on the sensors' machine)\n"
      "  orchard live my_robot.yaml --without drivers                (on the mapping machine)\n"
      "  orchard live my_robot.yaml --robot koala                    (one of several robots)\n"
      "Starts and watches the drivers of the rig, detector, pose, mapper and viewer. A failed\n"
      "process is restarted. Output: the map in DIR, the output of each process in DIR/logs.\n",
      run_live, [](CLI::App& command, LiveOptions& o) {
        add_required(command, "rig", o.config_path, "RIG", "configuration of the robot");
        add_value(command, "--out", o.out_folder, "DIR",
                  "folder for the map [out/live/DATE]; an existing map is continued");
        add_value(command, "--record", o.record_folder, "DIR",
                  "also record every message into this folder");
        add_value(command, "--only", o.only, "NAMES",
                  "run only these processes, such as drivers,recorder")
            ->delimiter(',');
        add_value(command, "--without", o.without, "NAMES", "run all but these processes")
            ->delimiter(',');
        command
            .add_option("--sim", o.scene,
                        "simulate the sensors in this scene instead of starting the drivers")
            ->check(CLI::IsMember({"tubes", "orchard", "park"}));
        add_value(command, "--emulate", o.played_log, "LOG",
                  "emulate the devices of the rig: each driver reads this log in its "
                  "device's protocol")
            ->excludes("--sim");
        command.add_flag("--edit", o.edit, "allow corrections of the map on the live page");
        command.add_option("--seed", o.seed, "seed of the simulated scene")->capture_default_str();
        command
            .add_option("--speed", o.speed,
                        "speed of the simulated drive, as a multiple of real time")
            ->capture_default_str();
        bus::add_network_options(command, o);
      });
}

void add_status(CLI::App& app, Run& run) {
  add_command<StatusOptions>(
      app, run, "status", "Show the status of all processes on all machines until Ctrl-C",
      "  orchard status --config my_robot.yaml\n"
      "  orchard status --once || echo needs attention\n"
      "Shows the rates, losses, latencies and warnings that each process reports by STATUS. Exit\n"
      "code of --once and --json: 1 if no process reports, or one is silent, has a warning, an\n"
      "error or a wrong clock.\n",
      run_status, [](CLI::App& command, StatusOptions& o) {
        add_network(command, o);
        command.add_flag("--once", o.once, "listen for 2.5 s, print the status once and exit");
        command.add_flag("--json", o.json, "listen for 2.5 s, print the status as JSON and exit");
      });
}

void add_record(CLI::App& app, Run& run) {
  add_command<RecordOptions>(
      app, run, "record", "Record all LCM messages until Ctrl-C, split into files",
      "  orchard record\n"
      "  orchard record --out /data --name north_block --split-mb 1000 --keep-gb 50\n"
      "  orchard map out/recordings/drive-*.lcm --config my_robot.yaml --out out/drive\n"
      "Output: LCM logs NAME-DATE-000.lcm, NAME-DATE-001.lcm, ..., readable by lcm-logplayer,\n"
      "too.\n",
      run_record, [](CLI::App& command, RecordOptions& o) {
        add_value(command, "--out", o.folder, "DIR", "folder of the recording")
            ->capture_default_str();
        add_value(command, "--name", o.name, "NAME", "first part of the file names")
            ->capture_default_str();
        add_limited(command, "--split-mb", o.split_mb, 1.0, 1e6,
                    "size of a file; then a new one begins [MB]");
        command
            .add_option("--keep-gb", o.keep_gb,
                        "max size of the recording: older files are removed [GB]; 0 = keep all")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
        command
            .add_option("--least-free-gb", o.least_free_gb,
                        "pause the recording, with a warning, while less disk space is free [GB]")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
        add_network(command, o);
      });
}

/// The board scene is in another program, so that mapping does not need its rendering code.
int simulate(const SimulateOptions& options) {
  const bool is_board = options.scene == "board";
  const auto function = is_board ? run_simulate_board : run_simulate;
  if (function == nullptr) replace_by_program(is_board ? "orchard-calibrate" : "orchard");
  return function(options);
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
      "Output: an LCM log for `orchard map`. Of a bag, the topic of each kind is found by its\n"
      "type; with several topics of a type, choose one by --topic. KIND is scan, scan_rear,\n"
      "image, odometry, imu, gnss or pose_fix. A PointCloud2 is cut into a scan by a horizontal\n"
      "slice. Damaged parts are skipped and reported.\n",
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
      "Input: a log with SCAN, and what pose.mode needs. Output: a folder with the map as table,\n"
      "picture, web page and GIS layers, the trajectory and summary.json. The map depends only\n"
      "on the log and the configuration: the same input gives the same files. Of a damaged log\n"
      "the readable part is mapped, with warnings; --strict refuses it. Without a rig in log or\n"
      "--config it is learnt first (orchard learn), and written as learnt.yaml.\n",
      run_map, [](CLI::App& command, MapOptions& o) {
        add_required(command, "log", o.log_paths, "LOG...",
                     "log to map, or the parts of a split log, in any order");
        add_rig(command, o.config_path);
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
  add_command<LogOptions>(*log, run, "info",
                          "List the channels of a log with counts, rates and times",
                          "  orchard log info drive.lcm\n"
                          "  orchard log info drive.lcm.00 drive.lcm.01 --json\n",
                          run_log_info, add_paths);
  add_command<LogOptions>(
      *log, run, "check", "Check a log for damage; exit code 3 if there is any",
      "  orchard log check drive.lcm && echo sound\n"
      "  orchard log check drive-000.lcm drive-001.lcm\n"
      "Reports unreadable bytes, invalid messages, missing sequence numbers and jumps of clocks.\n",
      run_log_check, add_paths);
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
  add_command<LogOptions>(
      *log, run, "split", "Write one log for each robot of a log of several",
      "  orchard log split base_station.lcm --out drives     (drives/koala.lcm, drives/heron.lcm)\n"
      "A log of a network of several robots, as lcm-logger records it, has channels such as\n"
      "koala/SCAN. Each robot's log has them under their own names; what belongs to none is in\n"
      "unnamed.lcm.\n",
      run_log_split, [](CLI::App& command, LogOptions& o) {
        add_required(command, "log", o.log_paths, "LOG...",
                     "log to read, or the parts of a split log");
        add_required(command, "--out", o.out_path, "DIR", "folder of the logs");
      });
  add_command<LogMcapOptions>(
      *log, run, "mcap", "Convert a log to MCAP, for Foxglove and Lichtblick",
      "  orchard log mcap drive.lcm --map out/drive --out drive.mcap\n"
      "Output: pictures, scans, fixes and transforms, and the map as markers. With --map, poses\n"
      "and map are those of the finished map; without it, the messages POSE, MAP and DETECTIONS\n"
      "of the log, if any.\n",
      run_log_mcap, [](CLI::App& command, LogMcapOptions& o) {
        add_required(command, "log", o.log_paths, "LOG...",
                     "log to convert, or the parts of a split log");
        add_value(command, "--map", o.map_path, "FOLDER|CSV", "finished map of this log");
        add_rig(command, o.config_path);
        add_required(command, "--out", o.out_path, "MCAP", "file to write");
      });
  log->footer(
      "Examples:\n"
      "  orchard log info drive.lcm\n"
      "  orchard log check drive.lcm\n"
      "  orchard log repair broken.lcm --out repaired.lcm\n");
}

void add_overlay(CLI::App& app, Run& run) {
  add_command<OverlayOptions>(
      app, run, "overlay", "Draw laser points and detections onto a picture of a log",
      "  orchard overlay drive.lcm --at 12.5 --out overlay.png          (with the rig stored in "
      "the log)\n"
      "  orchard overlay drive.lcm --at 1385942412500000 --config mine.yaml --out overlay.png\n"
      "Shows the scan points coloured by range (red near, blue far), the colour windows (white),\n"
      "the edge windows (grey) with the edge columns that the laser predicts (ticks), the edges\n"
      "found (cyan), and the confidences (below). Of a rig without a camera, shows the scan from\n"
      "above: returns, objects with their widths, and what is refused and why.\n",
      run_overlay, [](CLI::App& command, OverlayOptions& o) {
        add_required(command, "log", o.log_path, "LOG",
                     "log with SCAN and, of a rig with a camera, IMAGE");
        add_required(command, "--at", o.at, "TIME",
                     "seconds since the start of the log, or a utime [us]; draws the nearest "
                     "pair of scan and picture");
        add_rig(command, o.config_path);
        add_required(command, "--out", o.out_path, "SVG|PNG|PDF", "picture to write");
      });
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
        add_network(command, o);
      });
}

void add_learn(CLI::App& app, Run& run) {
  add_command<LearnOptions>(
      app, run, "learn", "Learn what a drive tells about its rig, and write the rig",
      "  orchard learn drive.lcm --out my.yaml\n"
      "  orchard learn drive-*.lcm --config sensors.yaml --out my.yaml\n"
      "Maps the drive twice. Learns where scanner and antenna are (from turns, with wheels or\n"
      "fixes), the noise of a range, the sector in which the robot sees itself, the trunks' width\n"
      "and the range up to which they are seen. Each value has a comment that says how it was "
      "seen\n"
      "and how surely; what the drive does not show is listed, to be measured by hand. A camera\n"
      "must be calibrated (orchard calibrate). The simplest drive: past twenty trunks, with a "
      "turn\n"
      "to each side.\n",
      run_learn, [](CLI::App& command, LearnOptions& o) {
        add_required(command, "logs", o.log_paths, "LOG...", "logs of one drive, in any order");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig to complete, such as one with a calibrated camera [none]");
        add_required(command, "--out", o.out_path, "RIG", "rig to write");
        command.add_flag("--quiet", o.quiet, "print only warnings and errors");
      });
}

void add_doctor(CLI::App& app, Run& run) {
  add_command<DoctorOptions>(
      app, run, "doctor", "Check this machine's network for LCM and print a fix for each problem",
      "  orchard doctor\n"
      "  orchard doctor --lcm-url 'udpm://239.255.76.67:7667?ttl=1'     (several machines)\n"
      "Tests routes, buffers, firewall and a message to itself, and lists the running processes\n"
      "of Orchard Mapper and clocks that differ. Exit code 1 if messages cannot get through.\n",
      run_doctor, [](CLI::App& command, DoctorOptions& o) {
        add_network(command, o);
        command.add_flag("--json", o.json, "print JSON");
      });
}

}  // namespace

void add_all_commands(CLI::App& app, Run& run) {
  add_simulate(app, run);
  add_import(app, run);
  add_map(app, run);
  add_evaluate(app, run);
  add_map_commands(app, run);
  add_overlay(app, run);
  add_log(app, run);
  add_live(app, run);
  add_status(app, run);
  add_record(app, run);
  add_farm(app, run);
  add_echo(app, run);
  add_doctor(app, run);
  add_learn(app, run);
  add_calibrate(app, run);
}

}  // namespace orchard::cli
