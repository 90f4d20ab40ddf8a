// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/node/process.hpp"
#include "pose/pose_node.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  return bus::run_node_process(
      argc, argv,
      {"orchard-pose",
       "Says where the robot is: POSE_FIX and ODOMETRY in (as pose.mode asks), POSE out.",
       {}},
      [](const io::Config& config) { return std::make_unique<procs::PoseNode>(config); });
}
