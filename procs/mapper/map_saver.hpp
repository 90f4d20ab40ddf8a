// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bus/process/process.hpp"
#include "mapper/mapper_node.hpp"

namespace orchard::procs {

/// Writes the files of a mapper process, always of the finished map: map.csv when the map has
/// changed, of a large map less often, and the whole folder when there is time and at the end.
class MapSaver {
 public:
  /// With an empty `folder` nothing is saved.
  MapSaver(std::string folder, std::int64_t config_hash)
      : folder_(std::move(folder)), config_hash_(config_hash) {}

  /// Saves map.csv first, since it fits on a disk where the others do not. Throws io::FileError and
  /// then leaves all other files as they were.
  void save(const MapperNode& mapper, const bus::SaveRequest& request);

  /// Sets warnings for summary.json in addition to the mapper's own.
  void set_notes(std::vector<std::string> notes) { notes_ = std::move(notes); }

  /// Forgets the saved map: the next save is of another one.
  void begin_new_map();

 private:
  void save_table(const std::vector<mapping::Landmark>& landmarks);
  void save_folder(const MapperNode& mapper, const bus::TrafficCounts& traffic);

  std::string folder_;
  std::int64_t config_hash_;
  std::vector<std::string> notes_;
  std::string saved_table_;          ///< content of map.csv in the folder; empty: unknown
  std::size_t num_passed_over_ = 0;  ///< saves of map.csv since the last
};

}  // namespace orchard::procs
