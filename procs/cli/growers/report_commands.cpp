// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/growers/plan_options.hpp"
#include "cli/growers/report.hpp"

namespace orchard::cli {

void add_report(CLI::App& app, Run& run) {
  add_command<ReportOptions>(
      app, run, "report", "Write a report of a map for growers, as web page and table",
      "  orchard report out/drive                          (out/drive/report/report.html ...)\n"
      "  orchard report out/autumn --previous out/spring   (with changes and growth)\n"
      "  orchard report out/drive --plan block.gpkg        (what differs from the plan)\n"
      "  orchard report out/drive --language es --out out/informe\n"
      "Output: report.html (a browser prints it on A4, or saves it as PDF) and report.csv, with "
      "trees,\n"
      "empty places and trunk cross-sectional area per row, diameters, a map of the block, parts "
      "that were not observed, and "
      "uncertainties. The\n"
      "figures are those of map.csv after corrections by hand (`orchard edit`).\n",
      run_report, [](CLI::App& command, ReportOptions& o) {
        add_required(command, "map", o.map_path, "FOLDER|CSV", "map folder, or its map.csv");
        add_value(command, "--previous", o.previous_path, "FOLDER",
                  "folder of an earlier map of the orchard: report changes and growth");
        add_value(command, "--plan", o.plan_path, "FILE",
                  "planting plan: report differences from it");
        add_value(command, "--out", o.out_folder, "DIR",
                  "folder to write to [report/ in the map folder]");
        add_value(command, "--name", o.name, "TEXT",
                  "name of the block in the report [name of the map folder]");
        command.add_option("--language", o.language, "language of the report: en or es")
            ->check(CLI::IsMember({"en", "es"}))
            ->capture_default_str();
        command.add_flag("--as-mapped", o.as_mapped, "ignore corrections by hand");
        command.add_flag("--json", o.json, "also print the table of rows as JSON");
        add_plan_options(command, o.plan_file, o.plan_match);
        add_alignment_options(command, o.alignment);
      });
}

}  // namespace orchard::cli
