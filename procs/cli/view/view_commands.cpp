// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/view/view.hpp"

namespace orchard::cli {

void add_view(CLI::App& app, Run& run) {
  add_command<ViewOptions>(
      app, run, "view",
      "Show a log or a map in a browser, to step through a drive or correct a map",
      "  orchard view drive.lcm --open            (play it, scan by scan)\n"
      "  orchard view drive.lcm.00 drive.lcm.01 --config mine.yaml\n"
      "  orchard view out/drive --edit --open     (correct the map on the page)\n"
      "  orchard view out/drive --listen 0.0.0.0:8420 --token-file token   (for the local "
      "network)\n"
      "Input: a log, which is mapped in the background and not changed, or a map folder, which is "
      "shown\n"
      "with its corrections. With --edit, corrections made on the page are saved as by `orchard "
      "edit`.\n"
      "Without --listen, only this machine can open the page.\n",
      run_view, [](CLI::App& command, ViewOptions& o) {
        add_required(command, "path", o.paths, "LOG...|FOLDER",
                     "a log, the parts of a split log, or a map folder");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig to use instead of the one in the log");
        add_value(command, "--listen", o.listen, "ADDRESS:PORT",
                  "address of the page [127.0.0.1:8420, or the next free port]");
        add_value(command, "--token-file", o.token_file, "FILE",
                  "file whose first line is the token for other hosts: http://...?token=TOKEN");
        command.add_flag("--edit", o.edit,
                         "allow everyone who can open the page to correct the map");
        command.add_flag("--open,!--no-browser", o.open, "open the page in a browser");
      });
}

}  // namespace orchard::cli
