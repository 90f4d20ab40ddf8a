// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <stdexcept>

#include "bus/bot_core/bot_core_driver.hpp"
#include "bus/process/process.hpp"
#include "io/config/config.hpp"

int main(int argc, char** argv) {
  using namespace orchard;
  std::string robot_url;
  bus::ProcessInfo info;
  info.name = "orchard-bot-core-adapter";
  info.description =
      "Translate messages of libbot's LCM types into those of Orchard Mapper.\n"
      "planar_lidar_t becomes SCAN, image_t IMAGE, pose_t ODOMETRY (or POSE_FIX), gps_data_t "
      "GNSS.\n"
      "Configuration: drivers.bot_core.";
  info.options = {{"--robot-url", "URL",
                   "URL of the robot's LCM network [drivers.bot_core.lcm_url]", &robot_url}};
  io::RigFile rig;
  return bus::run_device_process(argc, argv, info, rig, [&]() -> std::unique_ptr<bus::Driver> {
    device::BotCoreConfig config = rig.config().drivers.bot_core;
    if (!robot_url.empty()) config.lcm_url = robot_url;
    if (config.lcm_url.empty()) {
      throw std::invalid_argument(
          "the LCM network of the robot is unknown: set drivers.bot_core.lcm_url or give "
          "--robot-url");
    }
    const auto max_bytes = static_cast<std::size_t>(rig.config().drivers.camera.max_bytes);
    return std::make_unique<bus::BotCoreDriver>(config, max_bytes);
  });
}
