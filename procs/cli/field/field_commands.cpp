// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/field/live.hpp"
#include "cli/field/record.hpp"
#include "cli/field/status.hpp"

namespace orchard::cli {
namespace {

void add_network(CLI::App& command, std::string& lcm_url, std::string& config_path) {
  add_value(command, "--lcm-url", lcm_url, "URL",
            "URL of the LCM network [that of the rig, else $LCM_DEFAULT_URL, else the default]");
  add_value(command, "--config", config_path, "FILE", "rig whose LCM network is used");
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
      "Starts and watches the drivers of the rig, detector, pose, mapper and viewer. A failed "
      "process is\n"
      "restarted. Output: the map in DIR, the output of each process in DIR/logs.\n",
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
        add_value(command, "--lcm-url", o.lcm_url, "URL",
                  "URL of the LCM network [lcm.url of the rig]");
      });
}

void add_status(CLI::App& app, Run& run) {
  add_command<StatusOptions>(
      app, run, "status", "Show the status of all processes on all machines until Ctrl-C",
      "  orchard status --config my_robot.yaml\n"
      "  orchard status --once || echo needs attention\n"
      "Shows the rates, losses, latencies and warnings that each process reports by STATUS. Exit "
      "code of\n"
      "--once and --json: 1 if no process reports, or one is silent, has a warning, an error or a "
      "wrong\n"
      "clock.\n",
      run_status, [](CLI::App& command, StatusOptions& o) {
        add_network(command, o.lcm_url, o.config_path);
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
      "Output: LCM logs NAME-DATE-000.lcm, NAME-DATE-001.lcm, ..., readable by lcm-logplayer, "
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
        add_network(command, o.lcm_url, o.config_path);
      });
}

}  // namespace

void add_field(CLI::App& app, Run& run) {
  add_live(app, run);
  add_status(app, run);
  add_record(app, run);
}

}  // namespace orchard::cli
