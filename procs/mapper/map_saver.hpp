// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bus/node/process.hpp"
#include "mapper/mapper_node.hpp"

namespace orchard::procs {

/// Writes the files of a mapper process: map.csv whenever the map has changed, the whole folder
/// when there is time and at the end.
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
  std::vector<mapping::Landmark> numbered_landmarks(const MapperNode& mapper);

  std::string folder_;
  std::int64_t config_hash_;
  std::vector<std::string> notes_;
  std::string saved_table_;  ///< content of map.csv in the folder; empty: unknown
  /// (row, position) by landmark id, of the rows found last.
  std::vector<std::pair<std::int32_t, std::int32_t>> numbers_;
  /// The long objects last joined by numbered_landmarks(), and the ids of the landmarks that they
  /// replace.
  std::vector<mapping::Landmark> long_;
  std::set<std::int32_t> parts_;
  int saves_until_numbering_ = 0;
};

}  // namespace orchard::procs
