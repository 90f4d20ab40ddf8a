// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <string>

#include "cli/add_command.hpp"
#include "cli/calibrate_trunks.hpp"

namespace orchard::cli {

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App* calibrate = app.add_subcommand("calibrate", "Measure a rig's models from recordings");
  calibrate->require_subcommand(1);
  const char* examples =
      "  orchard calibrate trunks drive.lcm --config config/tubes.yaml --out config/mine.yaml\n"
      "  orchard calibrate trunks one.lcm two.lcm --config config/mine.yaml\n";
  add_command<CalibrateTrunksOptions>(
      *calibrate, run, "trunks",
      "Measure width and hue of the trunks in logs (the paper's initialisation) and write them "
      "into the rig's YAML",
      examples, run_calibrate_trunks, [](CLI::App& command, CalibrateTrunksOptions& o) {
        command.add_option("logs", o.log_paths, "drives past trunks of one kind")
            ->required()
            ->type_name("LOG...");
        command.add_option("--config", o.config_path, "the rig they were recorded with")
            ->required()
            ->type_name("FILE");
        command
            .add_option("--out", o.out_path,
                        "rig to write; without it that of --config, the old one kept as .bak")
            ->type_name("FILE");
        command.add_option("--wanted-trunks", o.wanted_trunks, "fewer give a warning")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
      });
  calibrate->footer(std::string("Examples:\n") + examples);
}

}  // namespace orchard::cli
