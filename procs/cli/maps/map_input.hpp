// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "io/map/stored_map.hpp"

namespace orchard::cli {

/// A map that a command reads: with what people corrected, or as it was mapped.
struct MapInput {
  io::StoredMap mapped;  ///< what was measured: by this, maps are laid on each other
  io::StoredMap map;     ///< the same with the corrected landmarks
  std::map<std::int32_t, std::string> row_names;
};

/// Reads a map folder with its corrections, unless `as_mapped`, or a map.csv alone. Says on stderr
/// in the name of `command` how many corrections are in conflict. Throws io::FileError.
MapInput read_map_input(const char* command, const std::string& path, bool as_mapped);

}  // namespace orchard::cli
