// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// What a map's summary.json says that a report tells; all of it empty where there is none.
struct SummaryFacts {
  std::string day;      ///< of the drive, "2026-11-22"; empty: not known
  std::string version;  ///< of the program that made the map
  double without_pictures_s = 0.0;
  int num_met_without_pictures = 0;  ///< things first seen then
  double without_fixes_s = 0.0;
  std::vector<std::string> warnings;
};

/// Reads the summary.json beside a map.csv, or in a map folder. A file that is absent says nothing.
/// `fix_channel`: the name by which it says that fixes were missing; all else missing is pictures.
/// Throws FileError for one that is no JSON of the right form.
SummaryFacts read_summary_facts(const std::string& folder_or_csv, std::string_view fix_channel);

}  // namespace orchard::io
