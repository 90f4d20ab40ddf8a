// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "io/map/map_folder_lock.hpp"
#include "mapper/map_saver.hpp"

namespace orchard::procs {

/// The file side of a mapper process: the folder of its map, its journal and its saves.
class MapperProcess {
 public:
  /// Makes the node; with a folder, one that resumes the map in it (a lockstep replay always starts
  /// a new map). Throws std::runtime_error when the folder cannot be written.
  std::unique_ptr<bus::Node> make_node(const io::Config& config, std::int64_t config_hash,
                                       const std::string& folder, bool lockstep);

  /// Saves the node of make_node(). Throws io::FileError after saving as much as possible.
  void save(bus::Node& node, const bus::SaveRequest& request);

 private:
  std::optional<io::MapFolderLock> place_;
  std::optional<MapSaver> saver_;
};

}  // namespace orchard::procs
