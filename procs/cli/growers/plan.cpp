// SPDX-License-Identifier: BSD-3-Clause
#include "cli/growers/plan.hpp"

#include <cstdio>

#include "bus/process/process.hpp"
#include "cli/growers/plan_registration.hpp"
#include "cli/maps/map_registration.hpp"
#include "cli/maps/stored_content.hpp"
#include "io/atomic_file.hpp"
#include "io/gis/plan_report.hpp"

namespace orchard::cli {
namespace {

void print_plan(const io::StoredPlan& plan) {
  std::printf("%s: %s, %s: %zu rows, %zu trees, rows %.2f m apart%s\n", plan.name.c_str(),
              plan.format.c_str(), plan.crs.c_str(), plan.plan.rows.size(), plan.plan.num_trees(),
              mapping::typical_alley_m(plan.plan), plan.georeference ? "" : "; not georeferenced");
  std::printf(
      "\n"
      "     row  trees  first ... last      length_m  spacing_m (min, max)\n");
  for (const mapping::PlannedRow& row : plan.plan.rows) {
    const mapping::PlannedRowFacts facts = mapping::row_facts(row);
    std::printf("%8s  %5zu  %8s ... %-8s  %8.1f  %9.2f (%.2f, %.2f)\n", row.name.c_str(),
                row.trees.size(), row.trees.front().name.c_str(), row.trees.back().name.c_str(),
                facts.length_m, facts.spacing_m, facts.spacing_min_m, facts.spacing_max_m);
  }
}

int look_at(const io::StoredPlan& plan, const PlanOptions& options) {
  if (!options.out_path.empty()) {
    io::write_file_atomically(options.out_path, io::plan_geojson(plan));
  }
  if (options.json) {
    std::fputs(io::plan_json(plan).c_str(), stdout);
    return bus::kExitOk;
  }
  print_plan(plan);
  if (!options.out_path.empty()) std::printf("\nwritten to %s\n", options.out_path.c_str());
  return bus::kExitOk;
}

}  // namespace

int run_plan(const PlanOptions& options) {
  const io::StoredPlan plan = io::read_plan(options.plan_path, options.file);
  for (const std::string& note : plan.notes) {
    std::fprintf(stderr, "orchard plan: note: %s\n", note.c_str());
  }
  if (options.map_path.empty()) return look_at(plan, options);
  const io::StoredMap map = io::read_stored_map(options.map_path);
  if (!options.out_path.empty()) require_other_folder(options.out_path, {options.map_path});
  RegisteredPlan laid = register_plan(plan, map, options.match);
  if (!options.out_path.empty()) {
    io::MapFolderContent content = content_of(map);
    content.summary.source = "numbered by a plan";
    apply_plan(laid, content);
    io::write_map_folder(options.out_path, content);
    write_plan_files(options.out_path, laid, content.landmarks);
  }
  if (options.json) {
    std::fputs(io::plan_match_json({laid.plan, map.landmarks, laid.match}).c_str(), stdout);
    return bus::kExitOk;
  }
  print_match(laid, map.landmarks);
  if (!options.out_path.empty()) {
    std::printf(
        "\n"
        "written to %s: the map with the plan's numbers, plan.csv and plan_rows.csv "
        "(differences),\n"
        "  plan.json, names.csv (names of the plan by landmark id)\n",
        options.out_path.c_str());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
