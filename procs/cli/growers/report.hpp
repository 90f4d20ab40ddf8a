// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "cli/maps/maps.hpp"
#include "io/map/stored_map.hpp"
#include "io/report/map_report.hpp"

namespace orchard::cli {

/// Lays the plan of --plan on a map, and counts.
using PlanLayer = std::function<io::PlanCounts(const io::StoredMap&)>;

/// Writes the report. `planned` is called only with --plan.
int write_report(const ReportOptions& options, const PlanLayer& planned);

}  // namespace orchard::cli
