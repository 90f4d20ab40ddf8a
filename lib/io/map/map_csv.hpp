// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::io {

/// map.csv as text: the columns listed in README.md, with fixed number formats.
std::string map_csv(const std::vector<mapping::Landmark>& landmarks);

/// Reads a map.csv (plain or .gz). The covariance, which the file lacks, is set to 0. Throws
/// FileError naming file, line and column of the first error, including a repeated id.
std::vector<mapping::Landmark> read_map_csv(const std::string& path);

/// Parses text instead; `name` replaces the path in messages.
std::vector<mapping::Landmark> parse_map_csv(std::string_view text, const std::string& name);

}  // namespace orchard::io
