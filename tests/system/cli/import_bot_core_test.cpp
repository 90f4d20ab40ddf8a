// SPDX-License-Identifier: BSD-3-Clause
// A robot that speaks libbot's types makes the map that the simulator's own messages make.
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "bot_core/image_t.hpp"
#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "io/map/map_csv.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

template <class M>
void write(io::LogWriter& writer, const std::string& channel, const M& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  writer.write(message.utime, channel, bytes);
}

/// The log as a robot with libbot would have recorded it.
void write_as_libbot(const std::string& from_path, const std::string& to_path) {
  io::LogReader reader(from_path);
  io::LogWriter writer(to_path);
  while (const auto event = reader.next()) {
    const auto channel = bus::find_channel(event->channel);
    if (!channel || bus::info(*channel).role != bus::Role::kSource) continue;
    const auto decoded = bus::decode(*channel, event->data.data(), event->data.size());
    const auto& message = std::get<bus::Message>(decoded);
    if (const auto* scan = std::get_if<laser::Scan>(&message)) {
      bot_core::planar_lidar_t lidar;
      lidar.utime = scan->utime;
      lidar.nranges = static_cast<int>(scan->ranges_m.size());
      lidar.ranges = scan->ranges_m;
      lidar.nintensities = 0;
      lidar.rad0 = static_cast<float>(scan->bearing_min_rad);
      lidar.radstep = static_cast<float>(scan->bearing_step_rad);
      write(writer, "HOKUYO", lidar);
    } else if (const auto* image = std::get_if<vision::Image>(&message)) {
      bot_core::image_t picture;
      picture.utime = image->utime;
      picture.width = image->width_px;
      picture.height = image->height_px;
      picture.row_stride = 0;
      picture.pixelformat = 1196444237;  // MJPG
      picture.size = static_cast<int>(image->data.size());
      picture.data = image->data;
      picture.nmetadata = 0;
      write(writer, "CAMERA", picture);
    } else if (const auto* fix = std::get_if<pose::PoseFix>(&message)) {
      bot_core::pose_t pose{};
      pose.utime = fix->utime;
      pose.pos[0] = fix->x_m;
      pose.pos[1] = fix->y_m;
      pose.orientation[0] = std::cos(fix->yaw_rad / 2);
      pose.orientation[3] = std::sin(fix->yaw_rad / 2);
      write(writer, "POSE", pose);
    }
  }
  writer.close();
}

TEST_F(CliTest, ALogOfLibbotsTypesMakesTheSameMap) {
  const std::string ours = path("ours.lcm");
  ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--seed", "3", "--out", ours}).exit_code, 0);
  write_as_libbot(ours, path("robot.lcm"));
  const Result config = orchard({"log", "config", ours});
  ASSERT_EQ(config.exit_code, 0);
  std::string rig = config.out;
  const std::string by_default = "pose_as: odometry";
  ASSERT_NE(rig.find(by_default), std::string::npos);
  rig.replace(rig.find(by_default), by_default.size(), "pose_as: pose_fix");
  write_file(path("rig.yaml"), rig);
  const Result import = orchard(
      {"import", path("robot.lcm"), "--config", path("rig.yaml"), "--out", path("imported.lcm")});
  ASSERT_EQ(import.exit_code, 0) << import.err;
  for (const char* channel : {"SCAN", "IMAGE", "POSE_FIX"}) {
    EXPECT_EQ(num_messages(path("imported.lcm"), channel), num_messages(ours, channel)) << channel;
  }
  ASSERT_EQ(orchard({"map", ours, "--config", path("rig.yaml"), "--out", path("a")}).exit_code, 0);
  const Result mapped =
      orchard({"map", path("imported.lcm"), "--config", path("rig.yaml"), "--out", path("b")});
  ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
  const auto expected = io::parse_map_csv(read_file(path("a/map.csv")), "a/map.csv");
  const auto found = io::parse_map_csv(read_file(path("b/map.csv")), "b/map.csv");
  ASSERT_GT(expected.size(), 5u);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].label, expected[i].label);
    EXPECT_NEAR(found[i].x_m, expected[i].x_m, 0.005);
    EXPECT_NEAR(found[i].y_m, expected[i].y_m, 0.005);
  }
}

TEST_F(CliTest, ALogWithoutLibbotsTypesIsRefused) {
  const std::string ours = path("ours.lcm");
  ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--seed", "3", "--out", ours}).exit_code, 0);
  const Result import = orchard({"import", ours, "--out", path("imported.lcm")});
  EXPECT_EQ(import.exit_code, 3);
  EXPECT_THAT(import.err, HasSubstr("has no message of libbot's types"));
}

}  // namespace
}  // namespace orchard::cli_test
