// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/growers/plan.hpp"
#include "cli/growers/plan_options.hpp"
#include "cli/growers/publish.hpp"

namespace orchard::cli {

void add_plan_options(CLI::App& command, io::PlanFileOptions& file,
                      mapping::PlanMatchConfig& match) {
  add_value(command, "--layer", file.layer, "NAME", "layer of the plan, if it has several");
  add_value(command, "--row-field", file.row_field, "NAME",
            "column of the plan with the name of the row");
  add_value(command, "--tree-field", file.tree_field, "NAME",
            "column of the plan with the name of the tree");
  add_value(command, "--crs", file.crs, "EPSG:CODE",
            "coordinate system of the plan, if the file does not state it");
  command
      .add_option("--spacing", file.spacing_m,
                  "distance between trees of a row, for a plan with rows as lines [m]")
      ->check(CLI::Range(0.2, 100.0));
  add_limited(command, "--tolerance", match.tolerance_m, 0.01, 10.0,
              "max distance of a tree from its planned position; beyond it the tree is `out of "
              "place` [m]");
  command
      .add_option("--placement", match.placement,
                  "number of the true placement, if several fit (they are listed)")
      ->check(CLI::Range(1, 100));
}

void add_plan(CLI::App& app, Run& run) {
  add_command<PlanOptions>(
      app, run, "plan", "Read a planting plan, or compare a map with it",
      "  orchard plan block.gpkg                                   (print its rows and trees)\n"
      "  orchard plan trees.csv --crs EPSG:25830 --out trees.geojson\n"
      "  orchard plan rows.shp --spacing 3.0 --map out/drive\n"
      "  orchard plan block.kml --map out/drive --out out/named    (map with the plan's numbers)\n"
      "  orchard plan grid.yaml --map out/drive --json\n"
      "Input: GeoPackage, Shapefile, GeoJSON, KML, DXF or CSV in any coordinate system, with trees "
      "as points\n"
      "or rows as lines; or YAML of a regular grid (rows, trees, row_spacing_m, tree_spacing_m, "
      "corner_deg,\n"
      "bearing_deg, rows_to, first_row, first_tree). Output: per row the missing, extra and "
      "misplaced\n"
      "trees. A map without GNSS is registered to the plan on its trees and takes its "
      "georeference; if\n"
      "several placements fit, they are listed (exit code 3).\n",
      run_plan, [](CLI::App& command, PlanOptions& o) {
        add_required(command, "plan", o.plan_path, "FILE", "file of the plan");
        add_value(command, "--map", o.map_path, "FOLDER|CSV", "map folder, or its map.csv");
        add_value(command, "--out", o.out_path, "DIR|GEOJSON",
                  "with --map: folder for the map with the plan's numbers; else: GeoJSON "
                  "file for the plan");
        add_plan_options(command, o.file, o.match);
        add_alignment_options(command, o.match.alignment);
        command.add_flag("--json", o.json, "print JSON, with lengths in metres");
      });
}

void add_publish(CLI::App& app, Run& run) {
  add_command<PublishOptions>(
      app, run, "publish", "Store a map in a PostGIS database",
      "  orchard publish out/drive --to postgresql://ana@farm.example/orchard --block north\n"
      "  orchard publish out/drive --to service=farm --block north --date 2026-04-10\n"
      "The map is stored in one transaction, entirely or not at all. A map of the same block and "
      "date is\n"
      "replaced; the rows that change are kept in orchard.tree_replaced. The password comes from "
      "~/.pgpass,\n"
      "PGPASSWORD or a service file.\n",
      run_publish, [](CLI::App& command, PublishOptions& o) {
        add_required(command, "map", o.map_path, "FOLDER|CSV", "map folder, or its map.csv");
        add_required(command, "--to", o.url, "URL", "URL of the database, without a password");
        add_required(command, "--block", o.block, "NAME",
                     "name of the block, the same for every date");
        add_value(command, "--date", o.date, "YYYY-MM-DD",
                  "date of the map [day of the drive, UTC]");
        command.add_flag("--as-mapped", o.as_mapped, "ignore corrections by hand");
        command.add_flag("--json", o.json, "print JSON");
      });
}

}  // namespace orchard::cli
