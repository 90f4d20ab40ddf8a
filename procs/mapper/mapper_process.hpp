// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bus/node/process.hpp"
#include "io/config/config.hpp"
#include "io/map/map_place.hpp"
#include "mapper/map_saver.hpp"

namespace orchard::procs {

/// What makes a mapper a process: the folder of its map, its journal and its saves.
class MapperProcess {
 public:
  /// The node; with a folder, one that goes on with the map in it (a replay in lockstep always
  /// begins anew). Throws std::runtime_error when the folder cannot be written.
  std::unique_ptr<bus::Node> make_node(const io::Config& config, std::int64_t config_hash,
                                       const std::string& folder, bool lockstep);

  /// Saves what make_node() made. Throws io::FileError once all that can be saved is.
  void save(bus::Node& node, const bus::SaveRequest& request);

 private:
  std::optional<io::MapPlace> place_;
  std::optional<MapSaver> saver_;
};

}  // namespace orchard::procs
