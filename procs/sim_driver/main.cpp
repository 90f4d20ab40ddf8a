// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <stdexcept>

#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "sim_driver/sim_source.hpp"

int main(int argc, char** argv) {
  orchard::procs::SimDriverOptions options;
  orchard::bus::ProcessInfo info;
  info.name = "orchard-sim-driver";
  info.description =
      "Simulate a drive and send the measurements of its sensors.\n"
      "Sends SCAN, IMAGE and POSE_FIX; except in scene tubes, also ODOMETRY, GNSS and IMU.";
  info.options = {
      {"--scene", "NAME", "scene: tubes (the paper's), orchard, park or yard [tubes]",
       &options.scene},
      {"--seed", "N", "seed of the layout and of all noise [1]", &options.seed},
      {"--truth", "CSV", "also write the true objects: class,x_m,y_m,width_m, on uneven ground z_m",
       &options.truth_path},
      {"--poses", "CSV",
       "also write the true poses of the robot: utime_us,x_m,y_m,yaw_rad, on uneven ground z_m, "
       "roll_rad, pitch_rad",
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
