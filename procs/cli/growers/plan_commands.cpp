// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/growers/plan.hpp"
#include "cli/growers/plan_options.hpp"
#include "cli/growers/publish.hpp"

namespace orchard::cli {

void add_plan_options(CLI::App& command, io::PlanFileOptions& file,
                      mapping::PlanMatchConfig& match) {
  command.add_option("--layer", file.layer, "which layer of the plan, where it has several")
      ->type_name("NAME");
  command.add_option("--row-field", file.row_field, "the plan's column with the row's name")
      ->type_name("NAME");
  command.add_option("--tree-field", file.tree_field, "the plan's column with the tree's name")
      ->type_name("NAME");
  command.add_option("--crs", file.crs, "the plan's coordinate system, where the file has none")
      ->type_name("EPSG:CODE");
  command
      .add_option("--spacing", file.spacing_m,
                  "from tree to tree [m], where the plan has rows as lines")
      ->check(CLI::Range(0.2, 100.0));
  command
      .add_option("--tolerance", match.tolerance_m,
                  "a tree farther from its place is out of place [m]")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  command
      .add_option("--placement", match.placement,
                  "where several placements of the plan fit: which one is true, as they are named")
      ->check(CLI::Range(1, 100));
}

void add_plan(CLI::App& app, Run& run) {
  add_command<PlanOptions>(
      app, run, "plan", "Read the grower's plan; tell what a map has of it",
      "  orchard plan block.gpkg                                   (what does it hold?)\n"
      "  orchard plan trees.csv --crs EPSG:25830 --out trees.geojson\n"
      "  orchard plan rows.shp --spacing 3.0 --map out/drive\n"
      "  orchard plan block.kml --map out/drive --out out/named    (map with the plan's numbers)\n"
      "  orchard plan grid.yaml --map out/drive --json\n"
      "GeoPackage, Shapefile, GeoJSON, KML, DXF, CSV in any coordinate system: trees as points or "
      "rows\n"
      "as lines. YAML: a regular grid (rows, trees, row_spacing_m, tree_spacing_m, corner_deg,\n"
      "bearing_deg, rows_to, first_row, first_tree). A map without satellites is laid on the plan "
      "by its\n"
      "trees, and tied to the earth by it; where several placements fit they are named (exit 3).\n",
      run_plan, [](CLI::App& command, PlanOptions& o) {
        command.add_option("plan", o.plan_path, "the plan")->required()->type_name("FILE");
        command.add_option("--map", o.map_path, "map folder, or its map.csv")
            ->type_name("FOLDER|CSV");
        command
            .add_option("--out", o.out_path,
                        "with --map a folder for the named map, else a GeoJSON file for the plan")
            ->type_name("DIR|GEOJSON");
        add_plan_options(command, o.file, o.match);
        add_alignment_options(command, o.match.alignment);
        command.add_flag("--json", o.json, "for programs; lengths in metres");
      });
}

void add_publish(CLI::App& app, Run& run) {
  add_command<PublishOptions>(
      app, run, "publish", "Put a map into PostGIS, beside all blocks and dates before",
      "  orchard publish out/drive --to postgresql://ana@farm.example/orchard --block north\n"
      "  orchard publish out/drive --to service=farm --block north --date 2026-04-10\n"
      "One transaction: all of the map or nothing. The same block and date again replaces it, and\n"
      "what it replaced is kept in orchard.tree_replaced. The password comes from ~/.pgpass,\n"
      "PGPASSWORD or a service file.\n",
      run_publish, [](CLI::App& command, PublishOptions& o) {
        command.add_option("map", o.map_path, "map folder, or its map.csv")
            ->required()
            ->type_name("FOLDER|CSV");
        command.add_option("--to", o.url, "database, without a password")
            ->required()
            ->type_name("URL");
        command.add_option("--block", o.block, "the block's name, the same at every date")
            ->required()
            ->type_name("NAME");
        command.add_option("--date", o.date, "without it the day of the drive (UTC)")
            ->type_name("YYYY-MM-DD");
        command.add_flag("--as-mapped", o.as_mapped, "without what people corrected");
        command.add_flag("--json", o.json, "for programs");
      });
}

}  // namespace orchard::cli
