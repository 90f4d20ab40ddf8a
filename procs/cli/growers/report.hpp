// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/gis/plan_file.hpp"
#include "mapping/compare/map_alignment.hpp"
#include "mapping/plan/plan_match.hpp"

namespace orchard::cli {

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
int run_report(const ReportOptions& options);

}  // namespace orchard::cli
