// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/view/view.hpp"

namespace orchard::cli {

void add_view(CLI::App& app, Run& run) {
  add_command<ViewOptions>(
      app, run, "view", "Open a log or a map in a browser: step through a drive, correct a map",
      "  orchard view drive.lcm --open            (play it, scan by scan)\n"
      "  orchard view drive.lcm.00 drive.lcm.01 --config mine.yaml\n"
      "  orchard view out/drive --edit --open     (correct the map on the page)\n"
      "  orchard view out/drive --listen 0.0.0.0:8420 --token-file token   (for the local "
      "network)\n"
      "In comes a log, which is mapped while you look on and never changed, or a map folder, "
      "whose\n"
      "page shows what people corrected. With --edit it takes corrections, as `orchard edit` "
      "does.\n"
      "Without --listen the page is for this machine alone.\n",
      run_view, [](CLI::App& command, ViewOptions& o) {
        command.add_option("path", o.paths, "log, or the pieces of one, or a map folder")
            ->required()
            ->type_name("LOG...|FOLDER");
        command.add_option("--config", o.config_path, "of a log: another rig than its own")
            ->type_name("FILE");
        command
            .add_option("--listen", o.listen,
                        "where the page is (127.0.0.1:8420, or the next port that is free)")
            ->type_name("ADDRESS:PORT");
        command
            .add_option("--token-file", o.token_file,
                        "whose first line lets other hosts look on: http://...?token=TOKEN")
            ->type_name("FILE");
        command.add_flag("--edit", o.edit, "who sees the page may correct the map");
        command.add_flag("--open,!--no-browser", o.open, "open it in the browser");
      });
}

}  // namespace orchard::cli
