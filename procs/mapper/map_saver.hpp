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

/// The files of a mapper that runs as a process: its map.csv whenever the map has changed, all of
/// them when there is time and at the end.
class MapSaver {
 public:
  /// Nothing is saved into an empty `folder`.
  MapSaver(std::string folder, std::int64_t config_hash)
      : folder_(std::move(folder)), config_hash_(config_hash) {}

  /// map.csv is replaced first, since it fits where the others do not. Throws io::FileError and
  /// then leaves every other earlier file as it was.
  void save(const MapperNode& mapper, const bus::SaveRequest& request);

  /// Sentences that summary.json says besides the mapper's own warning.
  void set_notes(std::vector<std::string> notes) { notes_ = std::move(notes); }

  /// The next save is of another map.
  void begin_new_map();

 private:
  void save_table(const std::vector<mapping::Landmark>& landmarks);
  void save_folder(const MapperNode& mapper, const bus::TrafficCounts& traffic);
  std::vector<mapping::Landmark> numbered_landmarks(const MapperNode& mapper);

  std::string folder_;
  std::int64_t config_hash_;
  std::vector<std::string> notes_;
  std::string saved_table_;  ///< map.csv as it stands in the folder; empty: unknown
  /// Of the rows found last: (row, position) by id.
  std::vector<std::pair<std::int32_t, std::int32_t>> numbers_;
  /// What numbered_landmarks() joined last, and of what.
  std::vector<mapping::Landmark> long_;
  std::set<std::int32_t> parts_;
  int saves_until_numbering_ = 0;
};

}  // namespace orchard::procs
