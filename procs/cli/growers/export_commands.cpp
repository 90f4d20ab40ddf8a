// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/growers/export.hpp"
#include "cli/growers/import_edits.hpp"

namespace orchard::cli {

void add_export(CLI::App& app, Run& run) {
  add_command<ExportOptions>(
      app, run, "export", "Write a map for other programs: GeoJSON, KML, Shapefile, DXF, CSV ...",
      "  orchard export out/drive --format kml --out trees.kml             (Google Earth)\n"
      "  orchard export out/drive --format shp --out block.shp.zip         (one file for QGIS, "
      "ArcGIS)\n"
      "  orchard export out/drive --format geojson --layer rows --out rows.geojson\n"
      "In comes a map folder, with what people corrected; out goes one file, and on the terminal "
      "what it\n"
      "holds, in which coordinates, and what the format cannot hold. Coordinates are WGS 84 where "
      "the map\n"
      "has a datum, else metres of the map; KML and GeoJSON hold latitude and longitude alone and "
      "are\n"
      "refused without a datum. GeoJSON, CSV and FlatGeobuf hold one layer: landmarks, or that of "
      "--layer.\n",
      run_export, [](CLI::App& command, ExportOptions& o) {
        command.add_option("map", o.map_path, "map folder, or its map.csv")
            ->required()
            ->type_name("FOLDER|CSV");
        command.add_option("--format", o.format, "of the file")
            ->required()
            ->check(CLI::IsMember({"geojson", "kml", "shp", "dxf", "csv", "flatgeobuf", "gpkg"}));
        command
            .add_option("--out", o.out_path,
                        "file; .geojson, .kml, .shp.zip, .dxf, .csv, .fgb or .gpkg")
            ->required()
            ->type_name("FILE");
        command.add_option("--layer", o.layer, "this one alone")
            ->check(CLI::IsMember(
                {"landmarks", "extents", "path", "rows", "gaps", "alleys", "headlands", "nodes"}));
        command.add_flag("--as-mapped", o.as_mapped, "without what people corrected");
        command.add_flag("--overwrite", o.overwrite, "replace FILE where it is there already");
        command.add_flag("--json", o.json, "for programs");
      });
}

void add_import_edits(CLI::App& app, Run& run) {
  add_command<ImportEditsOptions>(
      app, run, "import-edits", "Take a map's GeoPackage back that was edited in QGIS",
      "  orchard export out/drive --format gpkg --out block.gpkg     (edit it in QGIS, save)\n"
      "  orchard import-edits out/drive block.gpkg --who Ana\n"
      "  orchard import-edits out/drive one_row.gpkg --keep-missing --dry-run\n"
      "In comes a GeoPackage of this map (map.gpkg, or one of `orchard export`) in which trees "
      "were\n"
      "deleted, added, moved, renumbered, or got another class or note, or rows another name. Out "
      "go\n"
      "corrections, as `orchard edit` makes them; the map stays as it is. What contradicts the map "
      "or\n"
      "what others have said since is a conflict: it is said, left out, and the exit code is 3.\n",
      run_import_edits, [](CLI::App& command, ImportEditsOptions& o) {
        command.add_option("map", o.map_folder, "map folder")->required()->type_name("FOLDER");
        command.add_option("edited", o.edited_path, "GeoPackage")->required()->type_name("GPKG");
        command.add_option("--who", o.who, "who edited it; without it the user of the system")
            ->type_name("NAME");
        command.add_flag("--keep-missing", o.keep_missing,
                         "what the file lacks was not deleted: it is a part of the map");
        command.add_flag("--dry-run", o.dry_run, "only say what would be added");
        command.add_flag("--json", o.json, "for programs");
      });
}

}  // namespace orchard::cli
