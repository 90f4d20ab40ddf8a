// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/gis/plan_file.hpp"
#include "mapping/plan/plan_match.hpp"

namespace orchard::io {

/// A plan matched to a map.
struct PlanReport {
  const StoredPlan& plan;
  const std::vector<mapping::Landmark>& landmarks;
  const mapping::PlanMatch& match;
};

/// plan.csv: a line for each planned and each extra tree. Columns: README.md.
std::string plan_csv(const PlanReport& report);

/// plan_rows.csv: a line for each row.
std::string plan_rows_csv(const PlanReport& report);

/// plan.json: counts, rows, and the trees that are not as planned.
std::string plan_match_json(const PlanReport& report);

/// The content of a plan as JSON.
std::string plan_json(const StoredPlan& plan);

/// The plan's trees as GeoJSON (WGS 84). Throws FileError for a plan that is not tied to the earth.
std::string plan_geojson(const StoredPlan& plan);

}  // namespace orchard::io
