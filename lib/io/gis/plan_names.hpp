// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/plan/plan_match.hpp"

namespace orchard::io {

/// names.csv: the plan's names by landmark id; names with commas or quotes are quoted.
std::string plan_names_csv(const std::vector<mapping::PlanName>& names);

/// Reads names.csv, by landmark id. Throws FileError naming the file and line.
std::map<std::int32_t, mapping::PlanName> read_plan_names(const std::string& path);

}  // namespace orchard::io
