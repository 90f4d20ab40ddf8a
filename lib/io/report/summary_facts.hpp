// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Facts from a map's summary.json that a report mentions; empty if there is no such file.
struct SummaryFacts {
  std::string day;      ///< date of the drive, "2026-11-22"; empty: unknown
  std::string version;  ///< version of the program that made the map
  double without_pictures_s = 0.0;
  int num_met_without_pictures = 0;  ///< landmarks first seen then
  double without_fixes_s = 0.0;
  std::vector<std::string> warnings;
};

/// Reads the summary.json beside a map.csv or in a map folder; a missing file gives empty facts.
/// `fix_channel`: name under which missing fixes are listed; all other missing inputs are counted
/// as images. Throws FileError for invalid JSON or another structure.
SummaryFacts read_summary_facts(const std::string& folder_or_csv, std::string_view fix_channel);

}  // namespace orchard::io
