// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "io/map/stored_map.hpp"

namespace orchard::cli {

/// An input map of a command: with its manual corrections, or as mapped.
struct MapInput {
  io::StoredMap mapped;  ///< the measured map, used to register maps
  io::StoredMap map;     ///< the map with the corrected landmarks
  std::map<std::int32_t, std::string> row_names;
};

/// Reads a map folder with its corrections, unless `as_mapped`, or a map.csv alone. Prints the
/// number of conflicting corrections on stderr, prefixed by `command`. Throws io::FileError.
MapInput read_map_input(const char* command, const std::string& path, bool as_mapped);

}  // namespace orchard::cli
