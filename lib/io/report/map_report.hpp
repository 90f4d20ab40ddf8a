// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/map/stored_map.hpp"
#include "io/report/report_texts.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "mapping/inventory/inventory.hpp"
#include "mapping/plan/plan_match.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::io {

/// An earlier map with which a report compares.
struct EarlierMap {
  std::string name;
  std::string day;
  std::vector<mapping::Landmark> landmarks;
  mapping::MapComparison comparison;  ///< a: the earlier map, b: this one
};

/// Counts of the map for a row of the grower's plan.
struct PlannedRowCounts {
  std::string name;                                       ///< name in the plan
  std::array<int, mapping::kNumPlanDeviations> counts{};  ///< in the order of PlanDeviation
  bool is_shifted = false;  ///< the whole row stands elsewhere than planned
};
struct PlanCounts {
  std::string name;  ///< file name of the plan
  std::vector<PlannedRowCounts> rows;
};

/// Input of a grower's report.
struct ReportContent {
  std::string name;  ///< name of the map
  SummaryFacts facts;
  StoredMap map;
  std::optional<EarlierMap> earlier{};
  std::optional<PlanCounts> plan{};
  mapping::RowNames row_names{};
};

/// The report as an HTML page: texts, tables and figures.
std::string map_report(const ReportContent& content, const ReportTexts& texts);

/// Table of the rows, column names first:
/// `row,trees,empty_places,empty_positions,diameter_mean_cm,tcsa_cm2,tcsa_sd_cm2` and, with an
/// earlier map, `measured_twice,tcsa_growth_cm2,tcsa_growth_percent`. Rows by name, "all" the
/// total, "other_trunks" those in no row, if there are any; they are not in the total. The decimal
/// sign is a point in every language.
std::vector<std::vector<std::string>> report_table(const ReportContent& content);

/// Formats that table as CSV.
std::string report_csv(const std::vector<std::vector<std::string>>& table);

}  // namespace orchard::io
