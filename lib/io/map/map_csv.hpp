// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::io {

/// map.csv as text: the columns of its README.md, fixed formatting.
std::string map_csv(const std::vector<mapping::Landmark>& landmarks);

/// Reads a map.csv (plain or .gz). Throws FileError naming file, line and column of the first
/// mistake, also for an id that stands there twice. The covariance, which a map.csv lacks, is 0.
std::vector<mapping::Landmark> read_map_csv(const std::string& path);

/// The same from text; `name` stands for the file in messages.
std::vector<mapping::Landmark> parse_map_csv(std::string_view text, const std::string& name);

}  // namespace orchard::io
