// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mapping/plan/plan_match.hpp"

namespace orchard::io {

/// names.csv: the plan's names by landmark id; names with commas or quotes are quoted.
std::string plan_names_csv(const mapping::PlanNames& names);

/// Reads names.csv. Throws FileError naming the file and line.
mapping::PlanNames read_plan_names(const std::string& path);

}  // namespace orchard::io
