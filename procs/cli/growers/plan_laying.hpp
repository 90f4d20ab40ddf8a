// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/gis/plan_file.hpp"
#include "io/map/map_folder.hpp"
#include "io/map/stored_map.hpp"
#include "mapping/plan/plan_numbers.hpp"

namespace orchard::cli {

/// A plan that lies on a map.
struct LaidPlan {
  io::StoredPlan plan;  ///< in map, where both are on the earth
  mapping::PlanMatch match;
  bool is_tied_by_plan = false;  ///< the map had no place on the earth, the plan gives it one
  mapping::PlanNumbers numbers;
};

/// Finds a plan's trees in a map. Where plan and map are both on the earth they are laid by that,
/// within the limits of `config`; else anywhere. Throws io::FileError in one sentence when it
/// cannot be laid, with all placements that fit when there are several.
LaidPlan lay_plan(const io::StoredPlan& plan, const io::StoredMap& map,
                  mapping::PlanMatchConfig config);

/// Gives the content of a map folder the plan's numbers and rows, and its place on the earth where
/// the map has none; says in its summary what differs from the plan.
void take_plan(LaidPlan& laid, io::MapFolderContent& content);

/// plan.csv, plan_rows.csv, plan.json and names.csv, beside a map. Throws io::FileError.
void write_plan_files(const std::string& folder, const LaidPlan& laid,
                      const std::vector<mapping::Landmark>& landmarks);

/// What a person reads: a line for each row, then the deviations.
void print_match(const LaidPlan& laid, const std::vector<mapping::Landmark>& landmarks);

}  // namespace orchard::cli
