// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "cli/add_command.hpp"
#include "cli/maps/compare.hpp"
#include "cli/maps/merge.hpp"
#include "geometry/angles.hpp"

namespace orchard::cli {
namespace {

void add_reach_option(CLI::App& command, double& reach_m) {
  command
      .add_option(
          "--reach", reach_m,
          "max range at which the laser detects trunks [m]; default: as stored in the map folders")
      ->check(CLI::Range(0.5, 500.0));
}

}  // namespace

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
                         "orchard: warning: --max-turn (degrees) will be removed in the next "
                         "release; use --max-turn-rad (radians)\n");
            c.turn_max_deg = deg;
          },
          "max rotation between the maps [degrees]; deprecated, use --max-turn-rad")
      ->check(CLI::Range(0.0, 180.0))
      ->group("");
  command.add_flag("--any-place", c.any_place,
                   "search all offsets and rotations, for maps in unrelated frames");
}

void add_compare(CLI::App& app, Run& run) {
  add_command<CompareOptions>(
      app, run, "compare", "Compare two maps of an orchard and list what changed",
      "  orchard compare out/spring out/autumn\n"
      "  orchard compare out/spring out/autumn --out out/changes     (CSV, GeoPackage, picture)\n"
      "  orchard compare out/spring out/autumn --json > changes.json\n"
      "  orchard compare a/map.csv b/map.csv --assume-seen --any-place\n"
      "Input: two map folders; their maps are aligned on the trunks. Output: trees that are "
      "unchanged,\n"
      "missing, new, moved, grown or thinner. A tree counts as missing only if the later drive "
      "could\n"
      "see its position; otherwise it is `not seen`. If a shift by a tree or a row explains the "
      "maps as\n"
      "well, the comparison is refused (exit code 3).\n",
      run_compare, [](CLI::App& command, CompareOptions& o) {
        add_required(command, "earlier", o.earlier_path, "FOLDER|CSV",
                     "earlier map: its folder or map.csv");
        add_required(command, "later", o.later_path, "FOLDER|CSV",
                     "later map: its folder or map.csv");
        add_value(command, "--out", o.out_folder, "DIR",
                  "folder for the comparison; created if it does not exist");
        command.add_flag("--as-mapped", o.as_mapped, "ignore corrections by hand");
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
      "Input: map folders of one orchard. Output: a map folder in the frame of the first map, "
      "whose ids and\n"
      "numbers are kept; new landmarks get new ids, and ids.csv lists the id of each landmark "
      "before and\n"
      "after. Maps that do not fit, or fit in two ways, are refused (exit code 3) and nothing is "
      "written;\n"
      "with --leave-out the others are merged, and left_out.csv lists the refused maps with the "
      "reason.\n",
      run_merge, [](CLI::App& command, MergeOptions& o) {
        add_required(command, "maps", o.map_paths, "FOLDER|CSV...",
                     "two or more map folders or map.csv files; one is enough with --previous")
            ->expected(1, 1000);
        add_required(command, "--out", o.out_folder, "DIR",
                     "folder for the map; created if it does not exist");
        add_value(command, "--previous", o.previous_path, "FOLDER|CSV",
                  "map of an earlier date; landmarks found again keep their id and number");
        command.add_flag(
            "--leave-out", o.leave_out,
            "leave out maps that cannot be aligned with the others, and list them in left_out.csv");
        add_value(command, "--config", o.config_path, "FILE",
                  "rig whose mapper.rows numbers new rows");
        add_alignment_options(command, o.alignment);
        add_reach_option(command, o.reach_m);
      });
}

}  // namespace orchard::cli
