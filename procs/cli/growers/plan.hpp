// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/gis/plan_file.hpp"
#include "mapping/plan/plan_match.hpp"

namespace orchard::cli {

/// `orchard plan FILE [--map MAP]`.
struct PlanOptions {
  std::string plan_path;
  io::PlanFileOptions file;
  std::string map_path;  ///< empty: only the plan is looked at
  std::string out_path;  ///< with a map its folder, else a GeoJSON file; empty: only printed
  mapping::PlanMatchConfig match;
  bool json = false;
};

/// Reads a grower's plan and prints what it holds, or lays it on a map and prints what is missing,
/// extra or out of place; returns the exit code. Throws io::FileError.
int run_plan(const PlanOptions& options);

}  // namespace orchard::cli
