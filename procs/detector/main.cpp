// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/process/process.hpp"
#include "detector/detector_node.hpp"
#include "io/config/config.hpp"

int main(int argc, char** argv) {
  orchard::bus::ProcessInfo info;
  info.name = "orchard-detector";
  info.description =
      "Detect tree trunks and other objects in each laser scan and its camera picture.\n"
      "Reads SCAN and IMAGE, sends DETECTIONS.";
  orchard::io::RigFile rig;
  return orchard::bus::run_node_process(argc, argv, info, rig, [&] {
    return std::make_unique<orchard::procs::DetectorNode>(rig.config());
  });
}
