// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/gis/plan_file.hpp"
#include "io/map/map_edit.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "mapping/plan/plan_match.hpp"

namespace orchard::cli {

/// `orchard map LOG... --out DIR`.
struct MapOptions {
  std::vector<std::string> log_paths;  ///< logs of one drive, in any order
  std::string config_path;             ///< empty: the rig stored in the log; none there: learnt
  std::string out_folder;
  std::string previous_path;  ///< earlier map whose ids and numbers are kept; empty: none
  mapping::MapAlignmentConfig previous_alignment;
  bool strict = false;      ///< reject a log with any damage or any dropped message
  bool quiet = false;       ///< no progress and no summary; warnings and errors are still printed
  bool no_derived = false;  ///< no derived.lcm (intermediate messages); removes an earlier one
  int num_jobs = 0;         ///< number of threads; 0: one per core
  bool timing = false;      ///< print the cost of every thousand scans
};

/// Replays a log, or its parts, through detector, pose and mapper in this process and writes the
/// map folder; returns the exit code. Throws io::FileError, io::ConfigError and Interrupted, and
/// then leaves an earlier map in the folder unchanged.
[[gnu::weak]] int run_map(const MapOptions& options);

/// `orchard compare MAP_A MAP_B`.
struct CompareOptions {
  std::string earlier_path;  ///< a map folder, or its map.csv
  std::string later_path;
  std::string out_folder;  ///< empty: only prints
  mapping::MapAlignmentConfig alignment;
  mapping::ComparisonConfig comparison;
  double reach_m = 0.0;    ///< max range of the laser; 0: that of the map folders
  bool as_mapped = false;  ///< without manual corrections
  bool json = false;
};

/// Registers the later map to the earlier one, prints the changes and writes them into a folder;
/// returns the exit code. Throws io::FileError for maps that cannot be read, that cannot be
/// aligned, or whose alignment is ambiguous.
[[gnu::weak]] int run_compare(const CompareOptions& options);

/// `orchard merge MAP_A MAP_B ... --out DIR`.
struct MergeOptions {
  std::vector<std::string> map_paths;  ///< map folders or map.csv; the first gives frame and ids
  /// Earlier maps, the newest first; ids and numbers are those of the first that a map fits.
  std::vector<std::string> previous_paths;
  bool leave_out = false;  ///< leave out maps that cannot be registered instead of failing
  std::string out_folder;
  std::string config_path;  ///< for mapper.rows; empty: its defaults
  mapping::MapAlignmentConfig alignment;
  double reach_m = 0.0;  ///< max range of the laser; 0: that of the map folders
};

/// Registers several maps of one orchard to each other and writes one map folder. Its ids.csv tells
/// the merged landmark of each input landmark. Returns the exit code. Throws io::FileError for maps
/// that cannot be read or whose registration fails or is ambiguous, and before an input would be
/// overwritten; then writes nothing.
///
/// With leave_out the merge starts from the first map that can be registered to a previous one;
/// where none can, from the map to which most others can be registered, and all ids are new.
/// left_out.csv lists the maps left out, the previous maps that none fits, and the reasons. Without
/// a majority for any map it is unknown which maps show the orchard, and all are rejected.
[[gnu::weak]] int run_merge(const MergeOptions& options);

/// `orchard edit KIND MAP ...`.
struct EditOptions {
  std::string map_folder;
  io::MapEdit edit;
  std::vector<double> at_m;  ///< x y [x y] in map
  std::string out_folder;    ///< apply
  std::string picture_path;  ///< background
  bool json = false;         ///< list, check
};

/// Adds one correction to the map's corrections; returns the exit code. Throws io::FileError,
/// without adding it, when it is impossible or would contradict the map.
[[gnu::weak]] int run_edit(const EditOptions& options);

/// Prints the corrections and the outcome of each.
[[gnu::weak]] int run_edit_list(const EditOptions& options);

/// Prints the corrections in conflict; returns exit code 3 when there are any.
[[gnu::weak]] int run_edit_check(const EditOptions& options);

/// Lays a picture from above under the map's page.
[[gnu::weak]] int run_edit_background(const EditOptions& options);

/// Writes the corrected map to a separate folder.
[[gnu::weak]] int run_edit_apply(const EditOptions& options);

/// The name of the current user, from the system.
std::string person();

/// `orchard export MAP --format WORD --out FILE`.
struct ExportOptions {
  std::string map_path;
  std::string format;
  std::string out_path;
  std::string layer;        ///< empty: all layers that the format supports
  double keep_out_m = 0.0;  ///< margin of the layer keep-outs; 0: no such layer
  bool as_mapped = false;
  bool overwrite = false;
  bool json = false;
};

/// Exports a map with its manual corrections to another format; returns the exit code. Throws
/// io::FileError.
[[gnu::weak]] int run_export(const ExportOptions& options);

/// `orchard tasks MAP --out FILE`.
struct TasksOptions {
  std::string map_path;
  std::string out_path;
  std::string ticked_path;    ///< the tasks of before; empty: none
  std::string previous_path;  ///< an earlier map; empty: none
  mapping::MapAlignmentConfig alignment;
  bool as_mapped = false;
  bool overwrite = false;
  bool json = false;
};

/// Writes what a map's gaps and changes call for, brought up to date with what was ticked; returns
/// the exit code. Throws io::FileError.
[[gnu::weak]] int run_tasks(const TasksOptions& options);

/// `orchard import-edits MAP EDITED.gpkg`.
struct ImportEditsOptions {
  std::string map_folder;
  std::string edited_path;
  std::string who;
  bool keep_missing = false;  ///< landmarks missing in the file were not deleted
  bool dry_run = false;
  bool json = false;
};

/// Adds the changes made in a map's GeoPackage to the map's corrections. Returns the exit code: 3
/// when some are in conflict; the others are added all the same. Throws io::FileError.
[[gnu::weak]] int run_import_edits(const ImportEditsOptions& options);

/// `orchard plan FILE [--map MAP]`.
struct PlanOptions {
  std::string plan_path;
  io::PlanFileOptions file;
  std::string map_path;  ///< empty: only reads the plan
  std::string out_path;  ///< with a map a map folder, else a GeoJSON file; empty: only prints
  mapping::PlanMatchConfig match;
  bool json = false;
  bool csv = false;               ///< prints the points, as a survey, instead
  std::vector<double> datum_deg;  ///< with csv: latitude, longitude; empty: amid the points
};

/// Reads a grower's plan and prints its content; with a map, registers the plan to it and prints
/// missing, extra and misplaced trees. Returns the exit code. Throws io::FileError.
[[gnu::weak]] int run_plan(const PlanOptions& options);

/// `orchard publish MAP --to URL --block NAME`.
struct PublishOptions {
  std::string map_path;
  std::string url;
  std::string block;
  std::string date;  ///< empty: the date of the drive
  bool as_mapped = false;
  bool json = false;
};

/// Writes a map with its manual corrections to PostGIS; returns the exit code. Throws
/// io::FileError, and std::runtime_error for errors of the server.
[[gnu::weak]] int run_publish(const PublishOptions& options);

/// `orchard report MAP`.
struct ReportOptions {
  std::string map_path;       ///< a map folder, or its map.csv
  std::string previous_path;  ///< an earlier map; empty: none
  std::string plan_path;      ///< the grower's plan; empty: none
  io::PlanFileOptions plan_file;
  mapping::PlanMatchConfig plan_match;
  std::string name;        ///< name of the map in the report; empty: that of its folder
  std::string out_folder;  ///< empty: folder `report` inside the map's
  std::string language = "en";
  mapping::MapAlignmentConfig alignment;
  bool as_mapped = false;  ///< without manual corrections
  bool json = false;       ///< prints the table of rows as JSON
};

/// Writes report.html and report.csv; returns the exit code. Throws io::FileError for
/// maps that cannot be read or registered.
[[gnu::weak]] int run_report(const ReportOptions& options);

/// `orchard view LOG|MAP_FOLDER`.
struct ViewOptions {
  std::vector<std::string> paths;  ///< a map folder, or the logs of one drive
  std::string config_path;         ///< for a log: a rig in place of the recorded one
  std::string listen;              ///< "ADDRESS", "ADDRESS:PORT", ":PORT"
  std::string token_file;
  bool edit = false;  ///< for a map folder: users of the page may correct the map
  bool open = false;  ///< open the page in the user's browser
};

/// Serves the page until Ctrl-C; returns the exit code. Throws io::FileError, io::ConfigError,
/// std::runtime_error.
[[gnu::weak]] int run_view(const ViewOptions& options);

}  // namespace orchard::cli
