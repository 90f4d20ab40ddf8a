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
  std::string map_path;  ///< empty: only reads the plan
  std::string out_path;  ///< with a map a map folder, else a GeoJSON file; empty: only prints
  mapping::PlanMatchConfig match;
  bool json = false;
};

/// Reads a grower's plan and prints its content; with a map, registers the plan to it and prints
/// missing, extra and misplaced trees. Returns the exit code. Throws io::FileError.
int run_plan(const PlanOptions& options);

}  // namespace orchard::cli
