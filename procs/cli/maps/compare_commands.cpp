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
      .add_option("--reach", reach_m,
                  "how far the laser finds trunks [m]; without it as the map folders say")
      ->check(CLI::Range(0.5, 500.0));
}

}  // namespace

void add_alignment_options(CLI::App& command, mapping::MapAlignmentConfig& c) {
  command
      .add_option("--max-offset", c.offset_max_m,
                  "how far apart the maps may place one tree, at most [m]")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  const double rad_per_deg = geometry::kPi / 180.0;
  command
      .add_option_function<double>(
          "--max-turn-rad", [&c, rad_per_deg](double rad) { c.turn_max_deg = rad / rad_per_deg; },
          "and how far they may be turned [rad]")
      ->check(CLI::Range(0.0, 3.15))
      ->default_str("0.175");
  command
      .add_option_function<double>(
          "--max-turn",
          [&c](double deg) {
            std::fprintf(stderr,
                         "orchard: warning: --max-turn (degrees) goes with the next release; use "
                         "--max-turn-rad (radians)\n");
            c.turn_max_deg = deg;
          },
          "the same [degrees], until the next release")
      ->check(CLI::Range(0.0, 180.0))
      ->group("");
  command.add_flag("--any-place", c.any_place,
                   "the maps' frames have nothing in common: any offset, any turn");
}

void add_compare(CLI::App& app, Run& run) {
  add_command<CompareOptions>(
      app, run, "compare", "Tell what changed between two maps of one orchard",
      "  orchard compare out/spring out/autumn\n"
      "  orchard compare out/spring out/autumn --out out/changes     (CSV, GeoPackage, picture)\n"
      "  orchard compare out/spring out/autumn --json > changes.json\n"
      "  orchard compare a/map.csv b/map.csv --assume-seen --any-place\n"
      "The maps are aligned on their trunks. A tree is missing only where the later drive looked\n"
      "and nothing nearer hid it; else it is not seen. When a shift by a tree or a row explains\n"
      "the maps as well, nothing is compared (exit 3).\n",
      run_compare, [](CLI::App& command, CompareOptions& o) {
        command.add_option("earlier", o.earlier_path, "map folder, or its map.csv")
            ->required()
            ->type_name("FOLDER|CSV");
        command.add_option("later", o.later_path, "map folder, or its map.csv")
            ->required()
            ->type_name("FOLDER|CSV");
        command.add_option("--out", o.out_folder, "folder for the comparison, made when missing")
            ->type_name("DIR");
        command.add_flag("--as-mapped", o.as_mapped, "without what people corrected");
        command.add_flag("--json", o.json, "for programs; lengths in metres");
        add_alignment_options(command, o.alignment);
        add_reach_option(command, o.reach_m);
        command
            .add_option("--min-confidence", o.comparison.confidence_min,
                        "missing and new trees that are less sure count as not seen, changed "
                        "widths as unchanged")
            ->check(CLI::Range(0.0, 1.0))
            ->capture_default_str();
        command
            .add_option("--sigmas", o.comparison.sigmas_min,
                        "moves and width changes below so many standard errors are none")
            ->check(CLI::Range(1.0, 20.0))
            ->capture_default_str();
        command
            .add_option("--bush-near", o.comparison.clump.near_m,
                        "a landmark with two others this near is part of a bush, of which each "
                        "drive sees other parts [m]")
            ->check(CLI::Range(0.05, 5.0))
            ->capture_default_str();
        command
            .add_option("--bush-reach", o.comparison.clump.reach_m,
                        "and comes or goes only where nothing else stands this near [m]")
            ->check(CLI::Range(0.05, 10.0))
            ->capture_default_str();
        command.add_flag("--assume-seen", o.comparison.assume_seen,
                         "both drives looked everywhere (for a map.csv without its folder)");
        command.add_flag("--objects", o.comparison.with_objects, "compare objects too");
      });
}

void add_merge(CLI::App& app, Run& run) {
  add_command<MergeOptions>(
      app, run, "merge", "Make one map of several drives or robots in one orchard",
      "  orchard merge out/monday out/tuesday --out out/both\n"
      "  orchard merge out/robot_1 out/robot_2 out/robot_3 --any-place --out out/all\n"
      "  orchard merge out/may_1 out/may_2 --previous out/april --leave-out --out out/may\n"
      "Maps are aligned on their trunks, in the frame of the first, whose ids and numbers are "
      "kept;\n"
      "what is new gets new ids, and ids.csv says which landmark of which map became which. Maps\n"
      "that do not fit, or fit in two ways, are refused (exit 3) and nothing is written; with\n"
      "--leave-out the rest is merged, and left_out.csv says which were left out, and why.\n",
      run_merge, [](CLI::App& command, MergeOptions& o) {
        command
            .add_option("maps", o.map_paths,
                        "map folders, or their map.csv; two or more, or one with --previous")
            ->required()
            ->expected(1, 1000)
            ->type_name("FOLDER|CSV...");
        command.add_option("--out", o.out_folder, "folder for the map, made when missing")
            ->required()
            ->type_name("DIR");
        command
            .add_option("--previous", o.previous_path,
                        "map of an earlier date: what is found again keeps its id and number")
            ->type_name("FOLDER|CSV");
        command.add_flag("--leave-out", o.leave_out,
                         "leave out what cannot be laid on the rest, and say so in left_out.csv");
        command.add_option("--config", o.config_path, "rig whose mapper.rows numbers new rows")
            ->type_name("FILE");
        add_alignment_options(command, o.alignment);
        add_reach_option(command, o.reach_m);
      });
}

}  // namespace orchard::cli
