// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/plan_report.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/csv.hpp"
#include "mapping/plan/orchard_plan.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::ordered_json;
using mapping::PlanDeviation;
using mapping::PlanFinding;

struct FindingNames {
  std::string row, tree, after;
};

FindingNames names_of(const PlanReport& report, const PlanFinding& f) {
  FindingNames names;
  if (f.row < 0) return names;
  const mapping::PlannedRow& row = report.plan.plan.rows[static_cast<std::size_t>(f.row)];
  names.row = row.name;
  if (f.tree < 0) return names;
  std::string& name = f.deviation == PlanDeviation::kExtra ? names.after : names.tree;
  name = row.trees[static_cast<std::size_t>(f.tree)].name;
  return names;
}

bool has_tree(const PlanFinding& f) {
  return f.deviation != PlanDeviation::kMissing && f.deviation != PlanDeviation::kNotSeen;
}

std::string id_text(const PlanReport& report, const PlanFinding& f) {
  return f.landmark < 0 ? std::string()
                        : std::to_string(report.landmarks[static_cast<std::size_t>(f.landmark)].id);
}

double rounded(double value, double step) { return std::round(value / step) * step; }

Json counts_json(const std::array<int, mapping::kNumPlanDeviations>& counts) {
  Json json;
  for (int k = 0; k < mapping::kNumPlanDeviations; ++k) {
    json[mapping::deviation_text(static_cast<PlanDeviation>(k))] =
        counts[static_cast<std::size_t>(k)];
  }
  return json;
}

}  // namespace

std::string plan_csv(const PlanReport& report) {
  std::string text = "row,tree,deviation,id,x_m,y_m,along_m,aside_m,confidence,after_tree\n";
  for (const PlanFinding& f : report.match.findings) {
    const FindingNames names = names_of(report, f);
    const bool has_offset = has_tree(f) && f.deviation != PlanDeviation::kExtra;
    text += csv_field(names.row) + "," + csv_field(names.tree) + "," +
            mapping::deviation_text(f.deviation) + "," + id_text(report, f) + "," +
            fixed_text(f.p_map.x(), 3) + "," + fixed_text(f.p_map.y(), 3) + "," +
            (has_offset ? fixed_text(f.along_m, 3) + "," + fixed_text(f.aside_m, 3) : ",") + "," +
            fixed_text(f.confidence, 3) + "," + csv_field(names.after) + "\n";
  }
  return text;
}

std::string plan_rows_csv(const PlanReport& report) {
  std::string text = "row,planned";
  for (int k = 0; k < mapping::kNumPlanDeviations; ++k) {
    text += std::string(",") + mapping::deviation_text(static_cast<PlanDeviation>(k));
  }
  text += ",along_m,aside_m,shifted\n";
  for (std::size_t r = 0; r < report.match.rows.size(); ++r) {
    const mapping::PlanRowFinding& row = report.match.rows[r];
    const mapping::PlannedRow& planned = report.plan.plan.rows[r];
    text += csv_field(planned.name) + "," + std::to_string(planned.trees.size());
    for (const int count : row.counts) text += "," + std::to_string(count);
    text += "," + fixed_text(row.shift.along_m, 3) + "," + fixed_text(row.shift.aside_m, 3) + "," +
            (row.is_shifted ? "1" : "0") + "\n";
  }
  return text;
}

std::string plan_match_json(const PlanReport& report) {
  Json json;
  json["plan"] = report.plan.name;
  json["notes"] = report.plan.notes;
  const geometry::Pose2& T = report.match.T_map_plan();
  json["shift"] = {{"x_m", rounded(T.x_m, 1e-3)},
                   {"y_m", rounded(T.y_m, 1e-3)},
                   {"yaw_rad", rounded(T.yaw_rad, 1e-6)}};
  json["rms_m"] = rounded(report.match.rms_m, 1e-3);
  json["trees"] = counts_json(report.match.counts);
  json["rows"] = Json::array();
  for (std::size_t r = 0; r < report.match.rows.size(); ++r) {
    const mapping::PlanRowFinding& row = report.match.rows[r];
    Json entry{{"row", report.plan.plan.rows[r].name}};
    entry.update(counts_json(row.counts));
    entry["along_m"] = rounded(row.shift.along_m, 1e-3);
    entry["aside_m"] = rounded(row.shift.aside_m, 1e-3);
    entry["shifted"] = row.is_shifted;
    json["rows"].push_back(std::move(entry));
  }
  json["deviations"] = Json::array();
  for (const PlanFinding& f : report.match.findings) {
    if (f.deviation == PlanDeviation::kAsPlanned) continue;
    const FindingNames names = names_of(report, f);
    Json entry{{"deviation", mapping::deviation_text(f.deviation)}, {"row", names.row}};
    if (f.deviation == PlanDeviation::kExtra) {
      entry["after_tree"] = names.after;
    } else {
      entry["tree"] = names.tree;
    }
    if (f.landmark >= 0) {
      entry["id"] = report.landmarks[static_cast<std::size_t>(f.landmark)].id;
    }
    entry["x_m"] = rounded(f.p_map.x(), 1e-3);
    entry["y_m"] = rounded(f.p_map.y(), 1e-3);
    if (f.deviation == PlanDeviation::kOutOfPlace) {
      entry["along_m"] = rounded(f.along_m, 1e-3);
      entry["aside_m"] = rounded(f.aside_m, 1e-3);
    }
    entry["confidence"] = rounded(f.confidence, 1e-3);
    json["deviations"].push_back(std::move(entry));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string plan_json(const StoredPlan& stored) {
  Json json;
  json["plan"] = stored.name;
  json["format"] = stored.format;
  json["crs"] = stored.crs;
  json["notes"] = stored.notes;
  json["num_trees"] = stored.plan.num_trees();
  json["aisle_m"] = rounded(mapping::typical_aisle_m(stored.plan), 1e-3);
  json["rows"] = Json::array();
  for (const mapping::PlannedRow& row : stored.plan.rows) {
    const mapping::PlannedRowFacts facts = mapping::row_facts(row);
    json["rows"].push_back({{"row", row.name},
                            {"trees", row.trees.size()},
                            {"first", row.trees.front().name},
                            {"last", row.trees.back().name},
                            {"length_m", rounded(facts.length_m, 1e-3)},
                            {"spacing_m", rounded(facts.spacing_m, 1e-3)},
                            {"spacing_least_m", rounded(facts.spacing_min_m, 1e-3)},
                            {"spacing_most_m", rounded(facts.spacing_max_m, 1e-3)}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string plan_geojson(const StoredPlan& stored) {
  if (!stored.georeference) {
    throw FileError(stored.name +
                    " is not georeferenced, but GeoJSON stores only latitude and longitude; give "
                    "its coordinate system with --crs");
  }
  std::string text = "{\"type\": \"FeatureCollection\", \"features\": [";
  bool is_first = true;
  for (const mapping::PlannedRow& row : stored.plan.rows) {
    for (const mapping::PlannedTree& tree : row.trees) {
      const geometry::Geodetic place = geometry::geodetic_of(*stored.georeference, tree.p_plan);
      const Json names{{"row", row.name}, {"tree", tree.name}};
      text += std::string(is_first ? "" : ",") + "\n{\"type\": \"Feature\", \"properties\": " +
              names.dump(-1, ' ', false, Json::error_handler_t::replace) +
              ", \"geometry\": {\"type\": \"Point\", \"coordinates\": [" +
              fixed_text(place.longitude_deg, 9) + ", " + fixed_text(place.latitude_deg, 9) + "]}}";
      is_first = false;
    }
  }
  return text + "\n]}\n";
}

}  // namespace orchard::io
