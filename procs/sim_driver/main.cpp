// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <stdexcept>

#include "bus/node/process.hpp"
#include "io/config/scene_rig.hpp"
#include "sim_driver/sim_source.hpp"

int main(int argc, char** argv) {
  orchard::procs::SimDriverOptions options;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-sim-driver";
  info.description =
      "Drives a simulated robot and publishes what its sensors measure.\n"
      "Sends SCAN, IMAGE and POSE_FIX; in the other scenes than tubes ODOMETRY, GNSS and IMU too.";
  info.options = {
      {"--scene", "NAME", "tubes (the paper's simulated environment) or orchard [tubes]",
       &options.scene},
      {"--seed", "N", "one seed gives one world and one run of it [1]", &options.seed},
      {"--truth", "CSV", "write what stands in the world: class,x_m,y_m,width_m",
       &options.truth_path},
      {"--poses", "CSV", "write where the robot truly was: utime_us,x_m,y_m,yaw_rad",
       &options.poses_path},
  };
  orchard::io::RigFile rig;
  info.load_default = [&] { rig = orchard::io::RigFile(orchard::io::scene_rig(options.scene)); };
  bool bad_usage = false;
  const int code = orchard::bus::run_driver_process(
      argc, argv, info, rig, [&]() -> std::unique_ptr<orchard::bus::Source> {
        try {
          return orchard::procs::make_sim_source(options, rig.config());
        } catch (const std::invalid_argument&) {
          bad_usage = true;  // unknown scene or invalid seed
          throw;
        }
      });
  return bad_usage ? orchard::bus::kExitUsage : code;
}
