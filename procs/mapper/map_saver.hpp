// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>

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

  /// Throws io::FileError and then leaves every earlier file as it was.
  void save(const MapperNode& mapper, const bus::SaveRequest& request);

 private:
  void save_table(const MapperNode& mapper);
  void save_folder(const MapperNode& mapper, const bus::TrafficCounts& traffic);

  std::string folder_;
  std::int64_t config_hash_;
  std::string saved_table_;  ///< map.csv as it stands in the folder; empty: unknown
};

}  // namespace orchard::procs
