// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/map_input.hpp"

#include <cstdio>

#include "io/map/corrected_map.hpp"

namespace orchard::cli {

MapInput read_map_input(const char* command, const std::string& path, bool as_mapped) {
  const io::CorrectedMapFolder folder = io::read_corrected_map(path, as_mapped);
  const int num_conflicts = folder.corrected.count(mapping::CorrectionOutcome::kConflict);
  if (num_conflicts > 0) {
    std::fprintf(stderr,
                 "%s: warning: %d corrections conflict with the map and are not applied; list them "
                 "with `orchard edit %s check`\n",
                 command, num_conflicts, path.c_str());
  }
  MapInput input{folder.mapped, folder.mapped, folder.corrected.row_names};
  input.map.landmarks = folder.corrected.landmarks;
  input.map.next_id = folder.corrected.next_id;
  return input;
}

}  // namespace orchard::cli
