// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "cli/add_command.hpp"
#include "cli/farm/farm.hpp"
#include "cli/maps/maps.hpp"
#include "geometry/angles.hpp"

namespace orchard::cli {

void add_alignment_options(CLI::App& command, mapping::MapAlignmentConfig& c) {
  add_limited(command, "--max-offset", c.offset_max_m, 0.01, 100.0,
              "max offset between the positions of a tree in both maps [m]");
  const double rad_per_deg = geometry::kPi / 180.0;
  command
      .add_option_function<double>(
          "--max-turn-rad", [&c, rad_per_deg](double rad) { c.turn_max_deg = rad / rad_per_deg; },
          "max rotation between the maps [rad]")
      ->check(CLI::Range(0.0, 3.15))
      ->default_str("0.175");
  command
      .add_option_function<double>(
          "--max-turn",
          [&c](double deg) {
            std::fprintf(stderr,
                         "orchard: warning: --max-turn (degrees) will be removed in the next\n"
                         "release; use --max-turn-rad (radians)\n");
            c.turn_max_deg = deg;
          },
          "max rotation between the maps [degrees]; deprecated, use --max-turn-rad")
      ->check(CLI::Range(0.0, 180.0))
      ->group("");
  command.add_flag("--any-place", c.any_place,
                   "search all offsets and rotations, for maps in unrelated frames");
}

namespace {

void add_map(CLI::App& command, std::string& path) {
  add_required(command, "map", path, "FOLDER|CSV", "map folder, or its map.csv");
}

void add_as_mapped(CLI::App& command, bool& as_mapped) {
  command.add_flag("--as-mapped", as_mapped, "ignore corrections by hand");
}

void add_reach_option(CLI::App& command, double& reach_m) {
  command
      .add_option(
          "--reach", reach_m,
          "max range at which the laser detects trunks [m]; default: as stored in the map folders")
      ->check(CLI::Range(0.5, 500.0));
}

void add_compare(CLI::App& app, Run& run) {
  add_command<CompareOptions>(
      app, run, "compare", "Compare two maps of an orchard and list what changed",
      "  orchard compare out/spring out/autumn\n"
      "  orchard compare out/spring out/autumn --out out/changes     (CSV, GeoPackage, picture)\n"
      "  orchard compare out/spring out/autumn --json > changes.json\n"
      "  orchard compare a/map.csv b/map.csv --assume-seen --any-place\n"
      "Input: two map folders; their maps are aligned on the trunks. Output: trees that are\n"
      "unchanged, missing, new, moved, grown or thinner. A tree counts as missing only if the\n"
      "later drive could see its position; otherwise it is `not seen`. If a shift by a tree or a\n"
      "row explains the maps as well, the comparison is refused (exit code 3).\n",
      run_compare, [](CLI::App& command, CompareOptions& o) {
        add_required(command, "earlier", o.earlier_path, "FOLDER|CSV",
                     "earlier map: its folder or map.csv");
        add_required(command, "later", o.later_path, "FOLDER|CSV",
                     "later map: its folder or map.csv");
        add_value(command, "--out", o.out_folder, "DIR",
                  "folder for the comparison; created if it does not exist");
        add_as_mapped(command, o.as_mapped);
        command.add_flag("--json", o.json, "print JSON, with lengths in metres");
        add_alignment_options(command, o.alignment);
        add_reach_option(command, o.reach_m);
        add_limited(command, "--min-confidence", o.comparison.confidence_min, 0.0, 1.0,
                    "min confidence of a change; below it, missing and new trees count as not "
                    "seen, widths as unchanged");
        add_limited(command, "--sigmas", o.comparison.sigmas_min, 1.0, 20.0,
                    "min number of standard errors of a reported move or width change");
        add_limited(command, "--bush-near", o.comparison.clump.near_m, 0.05, 5.0,
                    "a landmark with two others this near counts as part of a bush [m]");
        add_limited(command, "--bush-reach", o.comparison.clump.reach_m, 0.05, 10.0,
                    "part of a bush is new or missing only if no other landmark is this near [m]");
        command.add_flag(
            "--assume-seen", o.comparison.assume_seen,
            "assume that both drives observed everything (for a map.csv without its folder)");
        command.add_flag("--objects", o.comparison.with_objects, "also compare objects");
      });
}

void add_merge(CLI::App& app, Run& run) {
  add_command<MergeOptions>(
      app, run, "merge", "Merge maps of several drives or robots into one map",
      "  orchard merge out/monday out/tuesday --out out/both\n"
      "  orchard merge out/robot_1 out/robot_2 out/robot_3 --any-place --out out/all\n"
      "  orchard merge out/may_1 out/may_2 --previous out/april --leave-out --out out/may\n"
      "Input: map folders of one orchard. Output: a map folder in the frame of the first map,\n"
      "whose ids and numbers are kept; new landmarks get new ids, and ids.csv lists the id of\n"
      "each landmark before and after. Maps that do not fit, or fit in two ways, are refused\n"
      "(exit code 3) and nothing is written; with --leave-out the others are merged, and\n"
      "left_out.csv lists the refused maps with the reason.\n",
      run_merge, [](CLI::App& command, MergeOptions& o) {
        add_required(command, "maps", o.map_paths, "FOLDER|CSV...",
                     "two or more map folders or map.csv files; one is enough with --previous")
            ->expected(1, 1000);
        add_required(command, "--out", o.out_folder, "DIR",
                     "folder for the map; created if it does not exist");
        add_value(command, "--previous", o.previous_paths, "FOLDER|CSV",
                  "map of an earlier date; landmarks found again keep their id and number; may be "
                  "repeated, the newest first: the first that a map fits")
            ->allow_extra_args(false);
        command.add_flag(
            "--leave-out", o.leave_out,
            "leave out maps that cannot be aligned with the others, and list them in left_out.csv");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig whose mapper.rows numbers new rows");
        add_alignment_options(command, o.alignment);
        add_reach_option(command, o.reach_m);
      });
}

void add_view(CLI::App& app, Run& run) {
  add_command<ViewOptions>(
      app, run, "view",
      "Show a log or a map in a browser, to step through a drive or correct a map",
      "  orchard view drive.lcm --open            (play it, scan by scan)\n"
      "  orchard view drive.lcm.00 drive.lcm.01 --config mine.yaml\n"
      "  orchard view out/drive --edit --open     (correct the map on the page)\n"
      "  orchard view out/drive --listen 0.0.0.0:8420 --token-file token   (for the local "
      "network)\n"
      "Input: a log, which is mapped in the background and not changed, or a map folder, which\n"
      "is shown with its corrections. With --edit, corrections made on the page are saved as by\n"
      "`orchard edit`. Without --listen, only this machine can open the page.\n",
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

using mapping::CorrectionKind;

/// The subcommands of `orchard edit`; they share one options struct, since only one can be
/// given.
class EditCommands {
 public:
  EditCommands(CLI::App& edit, Run& run, std::shared_ptr<EditOptions> options)
      : edit_(edit), run_(run), options_(std::move(options)) {}

  CLI::App& add(CorrectionKind kind, const char* description, const char* examples) {
    CLI::App& command = add(mapping::correction_word(kind), description, examples, run_edit, kind);
    add_value(command, "--who", options_->who, "NAME",
              "name of the person who corrects [the current user]");
    if (kind != CorrectionKind::kNote) {
      add_value(command, "--note", options_->note, "TEXT", "reason of the correction");
    }
    return command;
  }
  CLI::App& add(const char* name, const char* description, const char* examples,
                int (*function)(const EditOptions&), CorrectionKind kind = CorrectionKind::kNote) {
    CLI::App& command = add_subcommand(edit_, name, description, examples);
    add_required(command, "map", options_->map_folder, "FOLDER", "map folder");
    on_command(command, [&run = run_, &edit = edit_, options = options_, function, kind] {
      options->kind = kind;
      run = [&edit, options, function] { return run_command(edit, function, *options); };
    });
    return command;
  }

  void tree(CLI::App& command) {
    add_required(command, "tree", options_->tree, "ID|ROW/TREE",
                 "id (17) or row/tree (3/14) of the landmark");
  }
  CLI::Option* at(CLI::App& command, int num_numbers, const char* description) {
    return add_value(command, "--at", options_->at_m, "X Y", description)->expected(num_numbers);
  }
  void class_word(CLI::App& command, const char* name) {
    command.add_option(name, options_->class_word, "class of the landmark: tree or object")
        ->check(CLI::IsMember({"tree", "object"}));
  }

  EditOptions& options() { return *options_; }

 private:
  CLI::App& edit_;
  Run& run_;
  std::shared_ptr<EditOptions> options_;
};

void add_tree_words(EditCommands& words) {
  words.tree(words.add(CorrectionKind::kDelete, "Delete a landmark that does not exist",
                       "  orchard edit delete out/drive 17 --who Ana --note \"a shadow\"\n"));
  CLI::App& add = words.add(CorrectionKind::kAdd, "Add a tree or object that the map lacks",
                            "  orchard edit add out/drive 3/14            (in the gap of row 3)\n"
                            "  orchard edit add out/drive --at 12.5 3.0 --width 0.12\n"
                            "  orchard edit add out/drive --at 1.0 -4.2 --class object\n");
  add_value(add, "gap", words.options().tree, "ROW/TREE", "row/tree of a gap in a row");
  words.at(add, 2, "position [m, map frame]");
  words.class_word(add, "--class");
  add.add_option("--width", words.options().width_m, "width of the trunk, if measured [m]")
      ->check(CLI::Range(0.001, 100.0));
  CLI::App& move = words.add(CorrectionKind::kMove, "Move a landmark",
                             "  orchard edit move out/drive 17 --at 12.5 3.0\n");
  words.tree(move);
  words.at(move, 2, "true position [m, map frame]")->required();
  CLI::App& label = words.add(CorrectionKind::kClass, "Change the class of a landmark",
                              "  orchard edit class out/drive 17 object\n");
  words.tree(label);
  label.add_option("class", words.options().class_word, "true class: tree or object")
      ->required()
      ->check(CLI::IsMember({"tree", "object"}));
  CLI::App& merge = words.add(
      CorrectionKind::kMerge, "Merge landmarks that are one tree or object",
      "  orchard edit merge out/drive 17 18\n"
      "The first keeps its id; the position is that of the landmark with the most observations.\n");
  add_required(merge, "trees", words.options().trees, "ID|ROW/TREE...",
               "ids (17) or row/tree (3/14) of the landmarks")
      ->expected(2, 100);
  CLI::App& split =
      words.add(CorrectionKind::kSplit, "Split a landmark that is two trees or objects",
                "  orchard edit split out/drive 17 --at 12.1 3.0 12.9 3.0\n"
                "The landmark at the first position keeps the id.\n");
  words.tree(split);
  words.at(split, 4, "positions of both [m, map frame]")->required()->type_name("X1 Y1 X2 Y2");
}

void add_number_words(EditCommands& words) {
  CLI::App& row = words.add(CorrectionKind::kRowName, "Name a row",
                            "  orchard edit row out/drive 3 \"by the road\"\n");
  row.add_option("row", words.options().row, "number of the row, or its current name")->required();
  row.add_option("name", words.options().name, "new name of the row")->required();
  CLI::App& renumber =
      words.add(CorrectionKind::kRenumber, "Change the row and the number of a tree",
                "  orchard edit renumber out/drive 17 --row 3 --position 14\n");
  words.tree(renumber);
  renumber.add_option("--row", words.options().row, "number or name of the row")->required();
  renumber
      .add_option("--position", words.options().position, "number of the tree in its row; 0 = none")
      ->required()
      ->check(CLI::Range(0, 1000000));
  CLI::App& note = words.add(CorrectionKind::kNote, "Attach a note to a landmark",
                             "  orchard edit note out/drive 3/14 \"grafted in March\"\n");
  words.tree(note);
  add_required(note, "text", words.options().note, "TEXT", "the note, one line");
}

void add_history_words(EditCommands& words) {
  for (const auto kind : {CorrectionKind::kUndo, CorrectionKind::kRedo}) {
    const bool undoes = kind == CorrectionKind::kUndo;
    CLI::App& command = words.add(
        kind, undoes ? "Undo a correction" : "Redo an undone correction",
        undoes
            ? "  orchard edit undo out/drive         (the last)\n  orchard edit undo out/drive 7\n"
            : "  orchard edit redo out/drive         (what was undone last)\n");
    command.add_option("number", words.options().of, "number of the correction [the last]")
        ->check(CLI::Range(1, 2147483646));
  }
  CLI::App& list = words.add("list", "List all corrections and whether each was applied",
                             "  orchard edit list out/drive --json\n", run_edit_list);
  list.add_flag("--json", words.options().json, "print JSON");
  CLI::App& check = words.add(
      "check", "List corrections that conflict with the map; exit code 3 if there are any",
      "  orchard edit check out/drive && echo sound\n", run_edit_check);
  check.add_flag("--json", words.options().json, "print JSON");
  CLI::App& apply = words.add(
      "apply", "Write the corrected map to a new folder",
      "  orchard edit apply out/drive --out out/corrected     (map.html, map.gpkg, map.csv ...)\n",
      run_edit_apply);
  add_required(apply, "--out", words.options().out_folder, "DIR",
               "folder for the map; created if it does not exist");
}

void add_edit(CLI::App& app, Run& run) {
  const auto options = std::make_shared<EditOptions>();
  CLI::App& edit = add_subcommand(
      app, "edit", "Correct a map by hand; corrections are kept when the orchard is mapped again",
      "  orchard edit delete out/drive 17 --note \"a shadow\"\n"
      "  orchard edit add out/drive 3/14\n"
      "  orchard edit list out/drive\n"
      "Corrections are saved in corrections.jsonl beside the map; the map itself is not changed.\n"
      "`orchard map --previous` applies them to the next map by id and position, and reports\n"
      "conflicts.\n");
  edit.require_subcommand(1);
  EditCommands words(edit, run, options);
  add_tree_words(words);
  add_number_words(words);
  add_history_words(words);
}

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
      "  orchard plan survey.csv --crs EPSG:27700 --csv > survey_m.csv      (for "
      "pose.prior_map)\n"
      "Input: GeoPackage, Shapefile, GeoJSON, KML, DXF or CSV in any coordinate system, with\n"
      "trees as points or rows as lines; or YAML of a regular grid (rows, trees, row_spacing_m,\n"
      "tree_spacing_m, corner_deg, bearing_deg, rows_to, first_row, first_tree). Output: per row\n"
      "the missing, extra and misplaced trees. A map without GNSS is registered to the plan on\n"
      "its trees and takes its georeference; if several placements fit, they are listed (exit\n"
      "code 3).\n",
      run_plan, [](CLI::App& command, PlanOptions& o) {
        add_required(command, "plan", o.plan_path, "FILE", "file of the plan");
        add_value(command, "--map", o.map_path, "FOLDER|CSV", "map folder, or its map.csv");
        add_value(command, "--out", o.out_path, "DIR|GEOJSON",
                  "with --map: folder for the map with the plan's numbers; else: GeoJSON "
                  "file for the plan");
        add_plan_options(command, o.file, o.match);
        add_alignment_options(command, o.match.alignment);
        auto* json = command.add_flag("--json", o.json, "print JSON, with lengths in metres");
        auto* csv = command
                        .add_flag("--csv", o.csv,
                                  "print all points, also those in no row: x_m,y_m,sd_m,row,tree, "
                                  "x east, y north from --datum, else from their middle")
                        ->excludes("--map", "--out")
                        ->excludes(json);
        add_value(command, "--datum", o.datum_deg, "LAT LON",
                  "origin of --csv, for points in degrees [degrees]")
            ->expected(2)
            ->check(CLI::Range(-180.0, 180.0))
            ->needs(csv);
      });
}

void add_publish(CLI::App& app, Run& run) {
  add_command<PublishOptions>(
      app, run, "publish", "Store a map in a PostGIS database",
      "  orchard publish out/drive --to postgresql://ana@farm.example/orchard --block north\n"
      "  orchard publish out/drive --to service=farm --block north --date 2026-04-10\n"
      "The map is stored in one transaction, entirely or not at all. A map of the same block and\n"
      "date is replaced; the rows that change are kept in orchard.tree_replaced. The password\n"
      "comes from ~/.pgpass, PGPASSWORD or a service file.\n",
      run_publish, [](CLI::App& command, PublishOptions& o) {
        add_map(command, o.map_path);
        add_required(command, "--to", o.url, "URL", "URL of the database, without a password");
        add_required(command, "--block", o.block, "NAME",
                     "name of the block, the same for every date");
        add_value(command, "--date", o.date, "YYYY-MM-DD",
                  "date of the map [day of the drive, UTC]");
        add_as_mapped(command, o.as_mapped);
        command.add_flag("--json", o.json, "print JSON");
      });
}

void add_report(CLI::App& app, Run& run) {
  add_command<ReportOptions>(
      app, run, "report", "Write a report of a map for growers, as web page and table",
      "  orchard report out/drive                          (out/drive/report/report.html ...)\n"
      "  orchard report out/autumn --previous out/spring   (with changes and growth)\n"
      "  orchard report out/drive --plan block.gpkg        (what differs from the plan)\n"
      "  orchard report out/drive --language es --out out/informe\n"
      "Output: report.html (a browser prints it on A4, or saves it as PDF) and report.csv, with\n"
      "trees, empty places and trunk cross-sectional area per row, diameters, a map of the\n"
      "block, parts that were not observed, and uncertainties. The figures are those of map.csv\n"
      "after corrections by hand (`orchard edit`).\n",
      run_report, [](CLI::App& command, ReportOptions& o) {
        add_map(command, o.map_path);
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
        add_as_mapped(command, o.as_mapped);
        command.add_flag("--json", o.json, "also print the table of rows as JSON");
        add_plan_options(command, o.plan_file, o.plan_match);
        add_alignment_options(command, o.alignment);
      });
}

void add_export(CLI::App& app, Run& run) {
  add_command<ExportOptions>(
      app, run, "export",
      "Export a map to GeoJSON, KML, Shapefile, DXF, CSV, FlatGeobuf or GeoPackage",
      "  orchard export out/drive --format kml --out trees.kml             (Google Earth)\n"
      "  orchard export out/drive --format shp --out block.shp.zip         (one file for QGIS, "
      "ArcGIS)\n"
      "  orchard export out/drive --format shp --out trees.shp              (one layer, with "
      "trees.dbf ... beside it)\n"
      "  orchard export out/drive --format geojson --layer rows --out rows.geojson\n"
      "Input: a map folder with its corrections. Output: one file, and on the terminal its\n"
      "layers, coordinates and what the format cannot store. Coordinates are WGS 84 if the map\n"
      "has a datum, else metres of the map. KML and GeoJSON store only latitude and longitude\n"
      "and need a datum. GeoJSON, CSV, FlatGeobuf and .shp store one layer: landmarks, or that\n"
      "of --layer.\n",
      run_export, [](CLI::App& command, ExportOptions& o) {
        add_map(command, o.map_path);
        command.add_option("--format", o.format, "format of the file")
            ->required()
            ->check(CLI::IsMember({"geojson", "kml", "shp", "dxf", "csv", "flatgeobuf", "gpkg"}));
        add_required(command, "--out", o.out_path, "FILE",
                     "file to write: .geojson, .kml, .shp.zip, .shp, .dxf, .csv, .fgb or .gpkg");
        command.add_option("--layer", o.layer, "export only this layer")
            ->check(CLI::IsMember(
                {"landmarks", "extents", "path", "rows", "gaps", "aisles", "headlands", "nodes"}));
        add_as_mapped(command, o.as_mapped);
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
      "Input: map.gpkg, or a GeoPackage of `orchard export`, in which trees were deleted, added,\n"
      "moved, renumbered, or got another class or note, or rows another name. Output: the\n"
      "differences as corrections, as `orchard edit` makes them; the map itself is not changed.\n"
      "An edit that contradicts the map or a later correction is a conflict: it is printed and\n"
      "left out, and the exit code is 3.\n",
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

void add_folder(CLI::App& command, std::string& folder) {
  add_required(command, "farm", folder, "DIR", "folder of the farm");
}

}  // namespace

void add_map_commands(CLI::App& app, Run& run) {
  add_compare(app, run);
  add_merge(app, run);
  add_view(app, run);
  add_edit(app, run);
  add_plan(app, run);
  add_report(app, run);
  add_publish(app, run);
  add_export(app, run);
  add_import_edits(app, run);
}

void add_farm(CLI::App& app, Run& run) {
  CLI::App* farm =
      app.add_subcommand("farm", "Map and compare many drives of many blocks, dates and robots");
  farm->require_subcommand(1);
  add_command<FarmInitOptions>(
      *farm, run, "init", "Create the folder of a farm, with a Snakefile",
      "  orchard farm init out/farm\n"
      "  orchard farm init out/farm --renew     (updates Snakefile and profiles)\n"
      "Output: farm.yaml, a Snakefile with the steps (map, merge, compare, report), profiles for\n"
      "clusters, and the folders logs/ and rigs/.\n",
      run_farm_init, [](CLI::App& command, FarmInitOptions& o) {
        add_folder(command, o.folder);
        command.add_flag("--renew", o.renew,
                         "overwrite Snakefile and profiles by those of this version");
      });
  add_command<FarmAddOptions>(
      *farm, run, "add", "Copy logs into the folder of a farm",
      "  orchard farm add out/farm drive.lcm --block north --date 2026-05-04 --robot mule\n"
      "The parts of a split log (drive-000.lcm, drive-001.lcm of `orchard record`, drive.lcm.00,\n"
      "drive.lcm.01 of lcm-logger) are one drive; each other name is a drive of its own. Output:\n"
      "logs/BLOCK/DATE/ROBOT/.\n",
      run_farm_add, [](CLI::App& command, FarmAddOptions& o) {
        add_folder(command, o.folder);
        add_required(command, "log", o.log_paths, "LOG...", "logs to copy");
        add_required(command, "--block", o.block, "NAME", "block of the orchard");
        add_required(command, "--date", o.date, "YYYY-MM-DD", "date of the drive");
        add_required(command, "--robot", o.robot, "NAME",
                     "name of the robot; its rig is rigs/NAME.yaml [the rig in the log]");
        command.add_flag("--link", o.link, "link to the logs instead of copying them");
      });
  add_command<FarmRunOptions>(
      *farm, run, "run", "Run all steps without a result yet, on this machine or on a cluster",
      "  orchard farm run out/farm\n"
      "  orchard farm run out/farm --profile slurm\n"
      "  orchard farm run out/farm && orchard farm publish out/farm\n"
      "  orchard farm run out/farm --keep-version     (after an upgrade: makes only what is "
      "missing)\n"
      "An unusable log is set aside with the reason, and the other logs are processed. After an\n"
      "interruption, run the command again to do the rest. Needs Snakemake (apt-get install\n"
      "snakemake). Exit code 1 if a step failed for another reason than its input.\n",
      run_farm_run, [](CLI::App& command, FarmRunOptions& o) {
        add_folder(command, o.folder);
        add_value(command, "--profile", o.profile, "NAME",
                  "where to run the steps: a folder in profiles/ of the farm")
            ->capture_default_str();
        command
            .add_option(
                "--cores", o.cores,
                "max number of cores [all]; on a cluster: max number of steps submitted at once")
            ->check(CLI::PositiveNumber);
        command.add_flag("--keep-version", o.keep_version,
                         "keep the results of an older program or Snakefile, and add to them");
        command.add_flag("--dry-run", o.dry_run, "print the steps that are to be made");
      });
  add_command<FarmStatusOptions>(
      *farm, run, "status",
      "Show finished and open steps, logs set aside with the reason, and the remaining cost",
      "  orchard farm status out/farm\n"
      "  orchard farm status out/farm --json\n",
      run_farm_status, [](CLI::App& command, FarmStatusOptions& o) {
        add_folder(command, o.folder);
        command.add_flag("--json", o.json, "print JSON, in seconds and MB");
      });
  add_command<FarmOptions>(
      *farm, run, "publish", "Link finished results as maps/BLOCK/DATE and changes/BLOCK/DATE",
      "  orchard farm publish out/farm\n", run_farm_publish,
      [](CLI::App& command, FarmOptions& o) { add_folder(command, o.folder); });
  add_command<FarmOptions>(
      *farm, run, "verify",
      "Find results that were altered or deleted; exit code 3 if there are any",
      "  orchard farm verify out/farm\n", run_farm_verify,
      [](CLI::App& command, FarmOptions& o) { add_folder(command, o.folder); });
  add_command<FarmRetryOptions>(
      *farm, run, "retry", "Remove what was set aside, so that the next run tries it again",
      "  orchard farm retry out/farm\n"
      "  orchard farm retry out/farm north/2026-05-04/mule/drive\n"
      "What was made from it is removed, too.\n",
      run_farm_retry, [](CLI::App& command, FarmRetryOptions& o) {
        add_folder(command, o.folder);
        add_value(command, "name", o.name, "NAME",
                  "a step as `farm status` names it, or a result [all that was set aside]");
      });
  add_command<FarmOptions>(
      *farm, run, "clean", "Remove results that no step needs, and what killed steps left",
      "  orchard farm clean out/farm\n"
      "Results that are published or corrected by hand are kept. No job may run on a cluster.\n",
      run_farm_clean, [](CLI::App& command, FarmOptions& o) { add_folder(command, o.folder); });
  add_command<FarmStepOptions>(
      *farm, run, "step", "Run one step of a farm (called by the Snakefile)",
      "  orchard farm step map-0123 -- orchard map logs/b/d/r/drive.lcm --quiet --out @out\n"
      "  orchard farm step date-4567 --set-aside 'no drive of this date gave a map'\n",
      run_farm_step, [](CLI::App& command, FarmStepOptions& o) {
        command.add_option("name", o.name, "name of the result: results/NAME")->required();
        command.add_option("command", o.command,
                           "command to run; the word @out in it becomes the folder of the result");
        command.add_option("--set-aside", o.set_aside,
                           "store this reason instead of running a command");
      });
}

}  // namespace orchard::cli
