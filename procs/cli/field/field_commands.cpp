// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/field/live.hpp"
#include "cli/field/record.hpp"
#include "cli/field/status.hpp"

namespace orchard::cli {
namespace {

void add_network(CLI::App& command, std::string& lcm_url, std::string& config_path) {
  command
      .add_option("--lcm-url", lcm_url,
                  "LCM network (without: the rig's, then $LCM_DEFAULT_URL, then the default)")
      ->type_name("URL");
  command.add_option("--config", config_path, "rig whose network is used")->type_name("FILE");
}

void add_live(CLI::App& app, Run& run) {
  add_command<LiveOptions>(
      app, run, "live", "Start all processes of this machine, watch them, stop all at Ctrl-C",
      "  orchard live my_robot.yaml --record out/recordings\n"
      "  orchard live config/orchard.yaml --sim orchard --seed 7     (without hardware)\n"
      "  orchard live my_robot.yaml --emulate drive.lcm              (the drivers, without "
      "devices)\n"
      "  orchard live my_robot.yaml --only drivers                   (on the sensors' machine)\n"
      "  orchard live my_robot.yaml --without drivers                (on the other one)\n"
      "A process that fails is started again. What each printed is in DIR/logs.\n",
      run_live, [](CLI::App& command, LiveOptions& o) {
        command.add_option("rig", o.config_path, "the robot's YAML")->required()->type_name("RIG");
        command.add_option("--out", o.out_folder, "folder for the map [out/live/DATE]")
            ->type_name("DIR");
        command.add_option("--record", o.record_folder, "record every message into this folder")
            ->type_name("DIR");
        command.add_option("--only", o.only, "these processes alone, such as drivers,recorder")
            ->type_name("NAMES")
            ->delimiter(',');
        command.add_option("--without", o.without, "all but these processes")
            ->type_name("NAMES")
            ->delimiter(',');
        command.add_option("--sim", o.scene, "simulated sensors in place of the rig's: this scene")
            ->check(CLI::IsMember({"tubes", "orchard", "park"}));
        command
            .add_option(
                "--emulate", o.played_log,
                "devices that play this log, each in its own protocol, instead of the rig's")
            ->type_name("LOG")
            ->excludes("--sim");
        command.add_flag("--edit", o.edit, "people may correct the map on the page");
        command.add_option("--seed", o.seed, "of the simulated scene")->capture_default_str();
        command.add_option("--speed", o.speed, "of the simulated drive, times real time")
            ->capture_default_str();
        command.add_option("--lcm-url", o.lcm_url, "LCM network, instead of the rig's lcm.url")
            ->type_name("URL");
      });
}

void add_status(CLI::App& app, Run& run) {
  add_command<StatusOptions>(
      app, run, "status", "Show how every process on every machine is, until Ctrl-C",
      "  orchard status --config my_robot.yaml\n"
      "  orchard status --once || echo somebody should look\n"
      "Exit code of --once and --json: 1 when nobody was heard or somebody needs attention.\n",
      run_status, [](CLI::App& command, StatusOptions& o) {
        add_network(command, o.lcm_url, o.config_path);
        command.add_flag("--once", o.once, "listen for 2.5 s, print once and end");
        command.add_flag("--json", o.json, "the same for programs");
      });
}

void add_record(CLI::App& app, Run& run) {
  add_command<RecordOptions>(
      app, run, "record", "Record every message until Ctrl-C, split into files, minding the disk",
      "  orchard record\n"
      "  orchard record --out /data --name north_block --split-mb 1000 --keep-gb 50\n"
      "  orchard map out/recordings/drive-*.lcm --config my_robot.yaml --out out/drive\n"
      "The files are lcm-logger's format: NAME-DATE-000.lcm, NAME-DATE-001.lcm, ...\n",
      run_record, [](CLI::App& command, RecordOptions& o) {
        command.add_option("--out", o.folder, "folder")->type_name("DIR")->capture_default_str();
        command.add_option("--name", o.name, "first part of the files' names")
            ->type_name("NAME")
            ->capture_default_str();
        command.add_option("--split-mb", o.split_mb, "a new file after so many megabytes")
            ->check(CLI::Range(1.0, 1e6))
            ->capture_default_str();
        command
            .add_option(
                "--keep-gb", o.keep_gb,
                "remove this recording's oldest files beyond so many gigabytes; 0: keep all")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
        command
            .add_option("--least-free-gb", o.least_free_gb,
                        "record nothing while the disk has less left, and say so")
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
