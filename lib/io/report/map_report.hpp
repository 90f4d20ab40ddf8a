// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/map/stored_map.hpp"
#include "io/report/document.hpp"
#include "io/report/report_texts.hpp"
#include "io/report/summary_facts.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "mapping/inventory/growth.hpp"
#include "mapping/inventory/inventory.hpp"

namespace orchard::io {

/// An earlier map that a report is compared with.
struct EarlierMap {
  std::string name;
  std::string day;
  std::vector<mapping::Landmark> landmarks;
  mapping::MapComparison comparison;  ///< a: the earlier map, b: this one
};

/// A row of the grower's plan, and what the map has of it.
struct PlannedRowCounts {
  std::string name;  ///< as the plan has it
  int num_as_planned = 0, num_out_of_place = 0, num_missing = 0, num_not_seen = 0, num_extra = 0;
  bool is_shifted = false;  ///< it was set out elsewhere as a whole
};
struct PlanCounts {
  std::string name;  ///< of its file
  std::vector<PlannedRowCounts> rows;
};

/// What a grower's report is made of.
struct ReportContent {
  std::string name;  ///< of the map
  SummaryFacts facts;
  StoredMap map;
  std::optional<EarlierMap> earlier{};
  std::optional<PlanCounts> plan{};
  std::map<std::int32_t, std::string> row_names{};  ///< of rows that people call otherwise
};

/// The report in words, tables and pictures.
Document map_report(const ReportContent& content, const ReportTexts& texts);

/// Its table of rows, the names of the columns first:
/// `row,trees,empty_places,empty_positions,diameter_mean_cm,tcsa_cm2,tcsa_sd_cm2` and, with an
/// earlier map, `measured_twice,tcsa_growth_cm2,tcsa_growth_percent`. Row 0 is what stands in no
/// row, "all" everything. Points as decimal signs in every language.
std::vector<std::vector<std::string>> report_table(const ReportContent& content);

/// That table as CSV.
std::string report_csv(const std::vector<std::vector<std::string>>& table);

}  // namespace orchard::io
