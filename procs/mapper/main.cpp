// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "bus/node/process.hpp"
#include "io/config/config.hpp"
#include "mapper/mapper_process.hpp"

int main(int argc, char** argv) {
  std::string folder;
  bool lockstep = false;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-mapper";
  info.description =
      "Accumulates detections into the map of the orchard.\n"
      "Reads DETECTIONS, POSE and, for what is gone, SCAN; sends MAP, and saves the map's files "
      "while it runs. Started again with the same --out it goes on with the map there.";
  info.options.push_back(
      {"--out", "DIR", "folder of the map's files (none are saved without)", &folder});
  info.alone = true;
  info.lockstep = &lockstep;
  orchard::io::RigFile rig;
  orchard::procs::MapperProcess mapper;
  return orchard::bus::run_node_process(
      argc, argv, info, rig,
      [&] { return mapper.make_node(rig.config(), rig.effective().hash, folder, lockstep); },
      [&](orchard::bus::Node& node, const orchard::bus::SaveRequest& request) {
        mapper.save(node, request);
      });
}
