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
  add_required(command, "farm", folder, "DIR", "folder of the farm");
}

}  // namespace

void add_farm(CLI::App& app, Run& run) {
  CLI::App* farm =
      app.add_subcommand("farm", "Map and compare many drives of many blocks, dates and robots");
  farm->require_subcommand(1);
  add_command<FarmInitOptions>(
      *farm, run, "init", "Create the folder of a farm, with a Snakefile",
      "  orchard farm init out/farm\n"
      "  orchard farm init out/farm --renew     (updates Snakefile and profiles)\n"
      "Output: farm.yaml, a Snakefile with the steps (check, map, merge, compare), profiles for "
      "clusters,\n"
      "and the folders logs/ and rigs/.\n",
      run_farm_init, [](CLI::App& command, FarmInitOptions& o) {
        add_folder(command, o.folder);
        command.add_flag("--renew", o.renew,
                         "overwrite Snakefile and profiles by those of this version");
      });
  add_command<FarmAddOptions>(
      *farm, run, "add", "Copy logs into the folder of a farm",
      "  orchard farm add out/farm drive.lcm --block north --date 2026-05-04 --robot mule\n"
      "The parts of a split log (drive.lcm.00, drive.lcm.01) are one drive; each other name is a "
      "drive of its\n"
      "own. Output: logs/BLOCK/DATE/ROBOT/.\n",
      run_farm_add, [](CLI::App& command, FarmAddOptions& o) {
        add_folder(command, o.folder);
        add_required(command, "log", o.log_paths, "LOG...", "logs to copy");
        add_required(command, "--block", o.block, "NAME", "block of the orchard");
        add_required(command, "--date", o.date, "YYYY-MM-DD", "date of the drive");
        add_required(command, "--robot", o.robot, "NAME",
                     "name of the robot; its rig is rigs/NAME.yaml [the rig in the log]");
      });
  add_command<FarmRunOptions>(
      *farm, run, "run", "Run all steps without a result yet, on this machine or on a cluster",
      "  orchard farm run out/farm\n"
      "  orchard farm run out/farm --profile slurm\n"
      "  orchard farm run out/farm && orchard farm publish out/farm\n"
      "An unusable log is set aside with the reason, and the other logs are processed. After an\n"
      "interruption, run the command again to do the rest. Needs Snakemake (apt-get install "
      "snakemake).\n"
      "Exit code 1 if a step failed for another reason than its input.\n",
      run_farm_run, [](CLI::App& command, FarmRunOptions& o) {
        add_folder(command, o.folder);
        add_value(command, "--profile", o.profile, "NAME",
                  "where to run the steps: a folder in profiles/ of the farm")
            ->capture_default_str();
        command
            .add_option(
                "--cores", o.cores,
                "max number of cores [all]; on a cluster: max number of steps submitted at once")
            ->check(CLI::PositiveNumber);
      });
  add_command<FarmStatusOptions>(
      *farm, run, "status",
      "Show finished and open steps, logs set aside with the reason, and the remaining cost",
      "  orchard farm status out/farm\n"
      "  orchard farm status out/farm --json\n",
      run_farm_status, [](CLI::App& command, FarmStatusOptions& o) {
        add_folder(command, o.folder);
        command.add_flag("--json", o.json, "print JSON, in seconds and MB");
      });
  add_command<FarmPublishOptions>(
      *farm, run, "publish", "Link finished results as maps/BLOCK/DATE and changes/BLOCK/DATE",
      "  orchard farm publish out/farm\n", run_farm_publish,
      [](CLI::App& command, FarmPublishOptions& o) { add_folder(command, o.folder); });
  add_command<FarmStepOptions>(
      *farm, run, "step", "Run one step of a farm (called by the Snakefile)",
      "  orchard farm step map-0123 -- orchard map logs/b/d/r/drive.lcm --quiet --out @out\n"
      "  orchard farm step date-4567 --set-aside 'no drive of this date gave a map'\n",
      run_farm_step, [](CLI::App& command, FarmStepOptions& o) {
        command.add_option("name", o.name, "name of the result: results/NAME")->required();
        command.add_option("command", o.command,
                           "command to run; the word @out in it becomes the folder of the result");
        command.add_option("--set-aside", o.set_aside,
                           "store this reason instead of running a command");
        command.add_flag("--keep-output", o.keep_output,
                         "store the output of the command as the result, for any exit code");
      });
}

}  // namespace orchard::cli
