// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/growers/plan_options.hpp"
#include "cli/growers/report.hpp"

namespace orchard::cli {

void add_report(CLI::App& app, Run& run) {
  add_command<ReportOptions>(
      app, run, "report", "Write a map as a report for growers: a page, a PDF, a table",
      "  orchard report out/drive                          (out/drive/report/report.pdf ...)\n"
      "  orchard report out/autumn --previous out/spring   (with changes and growth)\n"
      "  orchard report out/drive --plan block.gpkg        (what differs from the plan)\n"
      "  orchard report out/drive --language es --out out/informe\n"
      "Trees, empty places and trunk cross-sectional area row by row, diameters, a picture of the\n"
      "block, what was not seen, how sure it is. Numbers are those of map.csv, with what\n"
      "people corrected (`orchard edit`).\n",
      run_report, [](CLI::App& command, ReportOptions& o) {
        command.add_option("map", o.map_path, "map folder, or its map.csv")
            ->required()
            ->type_name("FOLDER|CSV");
        command.add_option("--previous", o.previous_path, "an earlier map of the same orchard")
            ->type_name("FOLDER");
        command.add_option("--plan", o.plan_path, "the grower's plan: what differs from it")
            ->type_name("FILE");
        command
            .add_option("--out", o.out_folder,
                        "folder to write into; without it report in the map's")
            ->type_name("DIR");
        command.add_option("--name", o.name, "what the report calls it; without it the folder's")
            ->type_name("TEXT");
        command.add_option("--language", o.language, "of the report: en or es")
            ->check(CLI::IsMember({"en", "es"}))
            ->capture_default_str();
        command.add_flag("--as-mapped", o.as_mapped, "without what people corrected");
        command.add_flag("--json", o.json, "print the table of rows as JSON");
        add_plan_options(command, o.plan_file, o.plan_match);
        add_alignment_options(command, o.alignment);
      });
}

}  // namespace orchard::cli
