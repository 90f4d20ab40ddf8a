// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace orchard::io {

/// All texts of a grower's report in one language. {} are placeholders.
struct ReportTexts {
  const char* language;  ///< language code of HTML
  char decimal_point;    ///< in texts; files have a point in every language
  const char* title;     ///< {}: the map
  const char* subtitle;  ///< {}: the day, {}: the program's version
  const char* unknown_day;
  // What was counted.
  const char* counts;
  const char* trees;         ///< {} trees in {} rows
  const char* trees_no_row;  ///< {} of them in no row
  const char* gaps;          ///< {} empty places
  const char* objects;       ///< {} other things
  const char* area;          ///< {} cm2 in all, {} per tree
  const char* area_note;
  // The block's picture.
  const char* picture;
  const char* legend_tree;
  const char* legend_gap;
  const char* legend_object;
  const char* row_short;  ///< prefix of a row's number
  // Rows.
  const char* rows;
  const char* column_row;
  const char* column_trees;
  const char* column_gaps;
  const char* column_gap_positions;
  const char* column_diameter;
  const char* column_area;
  const char* column_area_error;
  const char* no_row;
  const char* total;
  // Diameters.
  const char* diameters;
  const char* diameter_axis;
  const char* trees_axis;
  const char* diameters_none;
  // Gaps.
  const char* gap_places;
  const char* gap_none;
  const char* column_place;
  const char* column_position;  ///< number along the row
  const char* column_geodetic;
  const char* gap_note;
  // Changes.
  const char* changes;
  const char* changes_since;  ///< {}: the earlier map, {}: its day
  const char* column_change;
  const char* column_count;
  const char* missing;
  const char* new_trees;
  const char* moved;
  const char* grown;
  const char* thinner;
  const char* unchanged;
  const char* not_compared;
  const char* growth;
  const char* growth_all;  ///< {} mm +- {} mm in diameter; {} cm2 in {} trees of both
  const char* column_growth;
  const char* column_growth_percent;
  const char* column_pairs;
  // The grower's plan.
  const char* plan;
  const char* plan_of;          ///< {}: the plan's file
  const char* plan_column_row;  ///< row name in the plan
  const char* as_planned;
  const char* out_of_place;
  const char* plan_missing;
  const char* plan_not_seen;
  const char* extra;
  const char* shifted;  ///< for a row that stands elsewhere than planned as a whole
  // What was not seen.
  const char* not_seen;
  const char* unseen;  ///< {} things never in the camera's view
  const char* all_seen;
  const char* without_pictures;  ///< {} s without pictures, {} things first seen then
  const char* without_fixes;     ///< {} s without satellites
  const char* changes_not_seen;  ///< {} trees of the earlier map were out of view this time
  const char* warnings;
  // How sure.
  const char* how_sure;
  const char* sure;    ///< {} sure, {} likely, {} unsure
  const char* places;  ///< positions are known to {} cm
  const char* widths;  ///< diameters to {} mm
  const char* width_bias;
};

/// Texts for "en" or "es"; null for another language.
const ReportTexts* find_report_texts(const std::string& language);

extern const ReportTexts kReportTextsEn;
extern const ReportTexts kReportTextsEs;

}  // namespace orchard::io
