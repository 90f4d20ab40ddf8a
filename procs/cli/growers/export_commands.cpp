// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "cli/add_command.hpp"
#include "cli/growers/export.hpp"
#include "cli/growers/import_edits.hpp"

namespace orchard::cli {

void add_export(CLI::App& app, Run& run) {
  add_command<ExportOptions>(
      app, run, "export",
      "Export a map to GeoJSON, KML, Shapefile, DXF, CSV, FlatGeobuf or GeoPackage",
      "  orchard export out/drive --format kml --out trees.kml             (Google Earth)\n"
      "  orchard export out/drive --format shp --out block.shp.zip         (one file for QGIS, "
      "ArcGIS)\n"
      "  orchard export out/drive --format geojson --layer rows --out rows.geojson\n"
      "Input: a map folder with its corrections. Output: one file, and on the terminal its "
      "layers,\n"
      "coordinates and what the format cannot store. Coordinates are WGS 84 if the map has a "
      "datum, else\n"
      "metres of the map. KML and GeoJSON store only latitude and longitude and need a datum. "
      "GeoJSON,\n"
      "CSV and FlatGeobuf store one layer: landmarks, or that of --layer.\n",
      run_export, [](CLI::App& command, ExportOptions& o) {
        add_required(command, "map", o.map_path, "FOLDER|CSV", "map folder, or its map.csv");
        command.add_option("--format", o.format, "format of the file")
            ->required()
            ->check(CLI::IsMember({"geojson", "kml", "shp", "dxf", "csv", "flatgeobuf", "gpkg"}));
        add_required(command, "--out", o.out_path, "FILE",
                     "file to write: .geojson, .kml, .shp.zip, .dxf, .csv, .fgb or .gpkg");
        command.add_option("--layer", o.layer, "export only this layer")
            ->check(CLI::IsMember(
                {"landmarks", "extents", "path", "rows", "gaps", "alleys", "headlands", "nodes"}));
        command.add_flag("--as-mapped", o.as_mapped, "ignore corrections by hand");
        command.add_flag("--overwrite", o.overwrite, "replace FILE if it exists");
        command.add_flag("--json", o.json, "print JSON");
      });
}

void add_import_edits(CLI::App& app, Run& run) {
  add_command<ImportEditsOptions>(
      app, run, "import-edits",
      "Import corrections from a GeoPackage of the map that was edited in QGIS",
      "  orchard export out/drive --format gpkg --out block.gpkg     (edit it in QGIS, save)\n"
      "  orchard import-edits out/drive block.gpkg --who Ana\n"
      "  orchard import-edits out/drive one_row.gpkg --keep-missing --dry-run\n"
      "Input: map.gpkg, or a GeoPackage of `orchard export`, in which trees were deleted, added, "
      "moved,\n"
      "renumbered, or got another class or note, or rows another name. Output: the differences as\n"
      "corrections, as `orchard edit` makes them; the map itself is not changed. An edit that "
      "contradicts\n"
      "the map or a later correction is a conflict: it is printed and left out, and the exit code "
      "is 3.\n",
      run_import_edits, [](CLI::App& command, ImportEditsOptions& o) {
        add_required(command, "map", o.map_folder, "FOLDER", "map folder");
        add_required(command, "edited", o.edited_path, "GPKG", "the edited GeoPackage");
        add_value(command, "--who", o.who, "NAME",
                  "name of the person who edited it [the current user]");
        command.add_flag(
            "--keep-missing", o.keep_missing,
            "the file holds only part of the map: do not delete landmarks that it lacks");
        command.add_flag("--dry-run", o.dry_run, "print the corrections without saving them");
        command.add_flag("--json", o.json, "print JSON");
      });
}

}  // namespace orchard::cli
