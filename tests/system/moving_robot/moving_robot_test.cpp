// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "bus/messages/codec.hpp"
#include "detector/detector_node.hpp"
#include "io/log/log_writer.hpp"
#include "system/moving_robot/moving_robot_run.hpp"

namespace orchard::test {
namespace {

io::Config short_rows() {
  io::Config config = io::load_config(ORCHARD_SOURCE_DIR "/config/orchard.yaml");
  config.simulation.orchard.num_rows = 2;
  config.simulation.orchard.trees_per_row = 8;
  return config;
}

TEST(MovingRobot, MapsAsWellAsOneThatStops) {
  io::Config config = short_rows();
  const double stopped_m = map_run(stop_and_go(11, config), config).map.trees.rmse;
  const RobotRun moving = drive(11, config, {0.0875, 0.0});  // pictures 50 ms after mid-sweep
  const Outcome with = map_run(moving, config);
  EXPECT_LT(with.map.trees.rmse - stopped_m, 0.010);
  EXPECT_GT(with.map.trees.num, 10);
  config.detector.use_odometry = false;
  const Outcome without = map_run(moving, config);
  EXPECT_GT(with.judged_tree(), without.judged_tree());
  config.mapper.deskew_pose_gap_max_s = 0.0;  // all of a scan at its first beam: it must show
  EXPECT_GT(map_run(moving, config).map.trees.rmse - stopped_m, 0.010);
}

TEST(MovingRobot, TheDelayOfAMisstampedCameraIsFound) {
  const io::Config config = short_rows();
  for (const double delay_s : {0.0, 0.05}) {
    const auto found = measure_delay({drive(12, config, {0.0375, delay_s})}, config);
    EXPECT_NEAR(found.delay_s, delay_s, 0.005);
    EXPECT_LT(found.se_s, 0.003);
    EXPECT_LT(std::abs(found.offset_px), 1.0);
  }
}

TEST(MovingRobot, TheCommandWritesTheDelayIntoTheRig) {
  const io::Config config = short_rows();
  const std::string folder = testing::TempDir() + "/moving_robot_" + std::to_string(getpid());
  std::filesystem::create_directories(folder);
  const std::string log = folder + "/curves.lcm", out = folder + "/rig.yaml";
  io::LogWriter writer(log);
  for (const bus::Message& message : drive(13, config, {0.0375, 0.08}).messages) {
    writer.write(bus::utime_of(message), bus::info(bus::channel_of(message)).name,
                 bus::encode(message));
  }
  writer.close();
  const std::string command =
      ORCHARD_BUILD_DIR "/bin/orchard calibrate delay " + log +
      " --quiet --config " ORCHARD_SOURCE_DIR "/config/orchard.yaml --out " + out;
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_NEAR(io::load_config(out).camera.delay_s, 0.08, 0.005);
  std::ostringstream text;
  text << std::ifstream(out).rdbuf();
  EXPECT_NE(text.str().find("# orchard calibrate delay: standard error"), std::string::npos);
  std::filesystem::remove_all(folder);
}

/// What `orchard map` says of a whole drive with a rig.
std::vector<Finding> findings_of(const RobotRun& run, const io::Config& config) {
  procs::DetectorNode detector(config);
  for (const bus::Message& message : run.messages) detector.handle(message, [](bus::Message) {});
  detector.flush([](bus::Message) {});
  EXPECT_EQ(detector.warning(), "");
  return detector.findings();
}

TEST(MovingRobot, ATurnedCameraIsNoticedAndARightOneIsNot) {
  io::Config config = short_rows();
  config.simulation.orchard.trees_per_row = 14;
  const RobotRun run = drive(14, config, {});
  EXPECT_TRUE(findings_of(run, config).empty());
  config.camera.extrinsics.phi_rad[2] += 0.04;
  const std::vector<Finding> findings = findings_of(run, config);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].name, "camera_yaw");
}

}  // namespace
}  // namespace orchard::test
