// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include "bus/node/process.hpp"
#include "io/config/config.hpp"
#include "mapper/map_saver.hpp"
#include "mapper/mapper_node.hpp"

int main(int argc, char** argv) {
  using orchard::procs::MapperNode;
  std::string folder;
  std::unique_ptr<orchard::procs::MapSaver> saver;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-mapper";
  info.description =
      "Accumulates detections into the map of the orchard.\n"
      "Reads DETECTIONS, POSE and, for what is gone, SCAN; sends MAP, and saves the map's files "
      "while it runs.";
  info.options.push_back(
      {"--out", "DIR", "folder of the map's files (none are saved without)", &folder});
  orchard::io::RigFile rig;
  return orchard::bus::run_node_process(
      argc, argv, info, rig,
      [&] {
        saver = std::make_unique<orchard::procs::MapSaver>(folder, rig.effective().hash);
        return std::make_unique<MapperNode>(rig.config());
      },
      [&](orchard::bus::Node& node, const orchard::bus::SaveRequest& request) {
        saver->save(dynamic_cast<const MapperNode&>(node), request);
      });
}
