// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/node/process.hpp"
#include "io/config/config.hpp"
#include "pose/pose_node.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  io::RigFile rig;
  return bus::run_node_process(
      argc, argv,
      {"orchard-pose",
       "Says where the robot is: POSE_FIX and ODOMETRY in (as pose.mode asks), POSE out.",
       {}},
      rig, [&] { return std::make_unique<procs::PoseNode>(rig.config()); });
}
