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
      "  orchard calibrate trunks one.lcm two.lcm --config config/mine.yaml\n"
      "  orchard calibrate trunks --images pictures --masks masks --only 000-019 --out "
      "model.yaml\n";
  add_command<CalibrateTrunksOptions>(
      *calibrate, run, "trunks",
      "Measure width and hue of the trunks in logs (the paper's initialisation), or what trunks "
      "look like in pictures with masks, and write it into the rig's YAML",
      examples, run_calibrate_trunks, [](CLI::App& command, CalibrateTrunksOptions& o) {
        command.add_option("logs", o.log_paths, "drives past trunks of one kind")
            ->type_name("LOG...");
        command
            .add_option("--config", o.config_path,
                        "the rig they were recorded with; with --images the defaults without it")
            ->type_name("FILE");
        MaskedPictureOptions& pictures = o.pictures;
        CLI::Option* images =
            command
                .add_option("--images", pictures.picture_folder,
                            "learn from pictures instead, windows on trunks against elsewhere")
                ->type_name("DIR");
        command
            .add_option("--masks", pictures.mask_folder,
                        "masks of the same names, trunks red; with --images")
            ->needs(images)
            ->type_name("DIR");
        command.add_option("--only", pictures.only, "numbers of the pictures, such as 000-019")
            ->needs(images);
        command
            .add_option("--out", o.out_path,
                        "rig to write; without it that of --config, the old one kept as .bak")
            ->type_name("FILE");
        command.add_option("--wanted-trunks", o.wanted_trunks, "fewer give a warning")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        command.add_flag("--quiet", o.quiet, "warnings and errors only");
        command.parse_complete_callback([&o] {
          const MaskedPictureOptions& p = o.pictures;
          if (p.picture_folder.empty()) {
            if (o.log_paths.empty()) throw CLI::RequiredError("logs (or --images and --masks)");
            if (o.config_path.empty()) throw CLI::RequiredError("--config");
            return;
          }
          if (!o.log_paths.empty()) throw CLI::ExcludesError("--images", "logs");
          if (p.mask_folder.empty()) throw CLI::RequiredError("--masks");
          if (o.out_path.empty() && o.config_path.empty()) throw CLI::RequiredError("--out");
        });
      });
  calibrate->footer(std::string("Examples:\n") + examples);
}

}  // namespace orchard::cli
