// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/farm/farm_files.hpp"
#include "cli/farm/farm_run.hpp"
#include "cli/farm/farm_status.hpp"
#include "cli/farm/farm_step.hpp"

namespace orchard::cli {
namespace {

void add_folder(CLI::App& command, std::string& folder) {
  command.add_option("farm", folder, "the farm's folder")->required()->type_name("DIR");
}

}  // namespace

void add_farm(CLI::App& app, Run& run) {
  CLI::App* farm = app.add_subcommand(
      "farm", "Many logs of many blocks, dates and robots: check, map, join, compare");
  farm->require_subcommand(1);
  add_command<FarmInitOptions>(
      *farm, run, "init", "Make a farm's folder, with the Snakefile that says what is done",
      "  orchard farm init out/farm\n"
      "  orchard farm init out/farm --renew     (Snakefile and profiles of this version)\n",
      run_farm_init, [](CLI::App& command, FarmInitOptions& o) {
        add_folder(command, o.folder);
        command.add_flag("--renew", o.renew, "write Snakefile and profiles anew");
      });
  add_command<FarmAddOptions>(
      *farm, run, "add", "Copy logs to where they belong",
      "  orchard farm add out/farm drive.lcm --block north --date 2026-05-04 --robot mule\n"
      "The pieces of one log (drive.lcm.00, drive.lcm.01) are one drive; other names are others.\n",
      run_farm_add, [](CLI::App& command, FarmAddOptions& o) {
        add_folder(command, o.folder);
        command.add_option("log", o.log_paths, "logs to copy")->required()->type_name("LOG...");
        command.add_option("--block", o.block, "of the orchard")->required()->type_name("NAME");
        command.add_option("--date", o.date, "of the drive")->required()->type_name("YYYY-MM-DD");
        command.add_option("--robot", o.robot, "its rig is rigs/NAME.yaml, else the log's own")
            ->required()
            ->type_name("NAME");
      });
  add_command<FarmRunOptions>(
      *farm, run, "run", "Make what is not made yet, on this machine's cores or on a cluster",
      "  orchard farm run out/farm\n"
      "  orchard farm run out/farm --profile slurm\n"
      "  orchard farm run out/farm && orchard farm publish out/farm\n"
      "A log that cannot be used is set aside with its reason, and the rest goes on. Whatever is\n"
      "killed, another run takes up what is left. Needs Snakemake (apt-get install snakemake).\n"
      "Exit code 1 when a step failed for another reason than its input.\n",
      run_farm_run, [](CLI::App& command, FarmRunOptions& o) {
        add_folder(command, o.folder);
        command.add_option("--profile", o.profile, "of the farm's profiles/: where steps run")
            ->type_name("NAME")
            ->capture_default_str();
        command
            .add_option("--cores", o.cores,
                        "of this machine at most [all]; on a cluster: steps sent at once")
            ->check(CLI::PositiveNumber);
      });
  add_command<FarmStatusOptions>(
      *farm, run, "status", "What is made, what was set aside and why, what is left and its cost",
      "  orchard farm status out/farm\n"
      "  orchard farm status out/farm --json\n",
      run_farm_status, [](CLI::App& command, FarmStatusOptions& o) {
        add_folder(command, o.folder);
        command.add_flag("--json", o.json, "for programs; seconds and MB");
      });
  add_command<FarmPublishOptions>(
      *farm, run, "publish", "Let maps/BLOCK/DATE and changes/BLOCK/DATE stand for what is made",
      "  orchard farm publish out/farm\n", run_farm_publish,
      [](CLI::App& command, FarmPublishOptions& o) { add_folder(command, o.folder); });
  add_command<FarmStepOptions>(
      *farm, run, "step", "Run one step in the farm's folder: what the Snakefile calls",
      "  orchard farm step map-0123 -- orchard map logs/b/d/r/drive.lcm --quiet --out @out\n"
      "  orchard farm step date-4567 --set-aside 'no drive of this date gave a map'\n",
      run_farm_step, [](CLI::App& command, FarmStepOptions& o) {
        command.add_option("name", o.name, "of the result: results/NAME")->required();
        command.add_option("command", o.command, "\"@out\" in it: the folder that it writes");
        command.add_option("--set-aside", o.set_aside, "no command: why there is no result");
        command.add_flag("--keep-output", o.keep_output,
                         "what it prints is the result, whatever it finds");
      });
}

}  // namespace orchard::cli
