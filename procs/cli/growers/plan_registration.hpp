// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/gis/plan_file.hpp"
#include "io/map/map_folder.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/plan/plan_match.hpp"

namespace orchard::cli {

/// A plan registered to a map.
struct RegisteredPlan {
  io::StoredPlan plan;  ///< in the map frame, where both are georeferenced
  mapping::PlanMatch match;
  bool is_georeferenced_by_plan = false;  ///< the map had no georeference and gets the plan's
};

/// Matches a plan's trees with a map. If both are georeferenced, the registration starts from that,
/// within the limits of `config`; otherwise it is unconstrained. Throws io::FileError in one
/// sentence when the registration fails, with all matching placements when it is ambiguous.
RegisteredPlan register_plan(const io::StoredPlan& plan, const io::StoredMap& map,
                             mapping::PlanMatchConfig config);

/// Writes the plan's numbers, names and rows into the content of a map folder, and the plan's
/// georeference where the map has none; lists the differences from the plan in its summary.
void apply_plan(const RegisteredPlan& laid, io::MapFolderContent& content);

/// Writes plan.csv, plan_rows.csv and plan.json beside a map. Throws io::FileError.
void write_plan_files(const std::string& folder, const RegisteredPlan& laid,
                      const std::vector<mapping::Landmark>& landmarks);

/// Prints the match for the user: a line for each row, then the deviations.
void print_match(const RegisteredPlan& laid, const std::vector<mapping::Landmark>& landmarks);

}  // namespace orchard::cli
