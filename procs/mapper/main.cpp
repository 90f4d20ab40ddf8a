// SPDX-License-Identifier: BSD-3-Clause
#include <malloc.h>

#include <string>

#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "mapper/mapper_process.hpp"

int main(int argc, char** argv) {
  std::string folder;
  bool lockstep = false;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-mapper";
  info.description =
      "Build the map of the orchard from detections and poses.\n"
      "Reads DETECTIONS, POSE and SCAN (to find landmarks that are gone), sends MAP and saves the "
      "files of\n"
      "the map while it runs. Started again with the same --out, it resumes the map in that "
      "folder.";
  info.options.push_back(
      {"--out", "DIR", "folder of the map; without it nothing is saved", &folder});
  info.alone = true;
  info.lockstep = &lockstep;
  orchard::io::RigFile rig;
  ::mallopt(M_ARENA_MAX, 1);  // what a save takes, the next one takes again, whatever its thread
  orchard::procs::MapperProcess mapper;
  return orchard::bus::run_node_process(
      argc, argv, info, rig,
      [&] { return mapper.make_node(rig.config(), rig.effective().hash, folder, lockstep); },
      [&](orchard::bus::Node& node, const orchard::bus::SaveRequest& request) {
        return mapper.save(node, request);
      });
}
