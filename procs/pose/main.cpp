// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "pose/pose_node.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  bus::ProcessInfo info;
  info.name = "orchard-pose";
  info.description =
      "Estimate the pose of the robot by the method of pose.mode.\n"
      "Reads POSE_FIX, ODOMETRY, IMU, GNSS, SCAN or DETECTIONS, sends POSE and TRAJECTORY.";
  io::RigFile rig;
  return bus::run_node_process(argc, argv, info, rig,
                               [&] { return std::make_unique<procs::PoseNode>(rig.config()); });
}
