// SPDX-License-Identifier: BSD-3-Clause
// The bytes are those of lcm-gen's own encoder for libbot's types.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "bot_core/gps_data_t.hpp"
#include "bot_core/image_t.hpp"
#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "bus/bot_core/bot_core_driver.hpp"
#include "orchard/scan_t.hpp"

namespace orchard::bus {
namespace {

template <class M>
std::vector<std::uint8_t> encoded(const M& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

template <class M>
std::optional<Message> translated(BotCoreTranslator& translator, const std::string& channel,
                                  const M& message) {
  const auto bytes = encoded(message);
  return translator.translate(channel, bytes.data(), bytes.size());
}

bot_core::planar_lidar_t lidar() {
  bot_core::planar_lidar_t message;
  message.utime = 1'700'000'000'123'456;
  message.nranges = 5;
  message.ranges = {1.0f, 2.5f, 0.0f, INFINITY, 31.0f};
  message.nintensities = 5;
  message.intensities = {1, 2, 3, 4, 5};
  message.rad0 = -1.5f;
  message.radstep = 0.25f;
  return message;
}

/// At (x, y) facing `yaw_rad`, pitched forward a little.
bot_core::pose_t pose(std::int64_t utime, double x_m, double y_m, double yaw_rad) {
  bot_core::pose_t message{};
  message.utime = utime;
  message.pos[0] = x_m;
  message.pos[1] = y_m;
  message.orientation[0] = std::cos(yaw_rad / 2);
  message.orientation[3] = std::sin(yaw_rad / 2);
  return message;
}

bot_core::image_t image(const std::string& fourcc, int width, int height, int row_stride,
                        std::vector<std::uint8_t> data) {
  bot_core::image_t message;
  message.utime = 5;
  message.width = width;
  message.height = height;
  message.row_stride = row_stride;
  message.pixelformat = 0;
  for (int i = 3; i >= 0; --i) {
    message.pixelformat =
        message.pixelformat << 8 | static_cast<unsigned char>(fourcc[static_cast<std::size_t>(i)]);
  }
  message.size = static_cast<int>(data.size());
  message.data = std::move(data);
  message.nmetadata = 2;
  message.metadata.resize(2);
  message.metadata[0] = {"shutter", 3, {1, 2, 3}};
  message.metadata[1] = {"", 0, {}};
  return message;
}

TEST(BotCore, ASweep) {
  BotCoreTranslator translator({}, 60000);
  const auto message = translated(translator, "HOKUYO_FRONT", lidar());
  ASSERT_TRUE(message);
  const auto& scan = std::get<laser::Scan>(*message);
  EXPECT_EQ(scan.utime, 1'700'000'000'123'456);
  EXPECT_EQ(scan.seq, 0);
  EXPECT_DOUBLE_EQ(scan.bearing_min_rad, -1.5);
  EXPECT_DOUBLE_EQ(scan.bearing_step_rad, 0.25);
  EXPECT_EQ(scan.ranges_m, lidar().ranges);
  EXPECT_EQ(scan.intensities, lidar().intensities);
  EXPECT_EQ(scan.beam_period_us, 0.0);
  EXPECT_TRUE(scan.valid(1));
  EXPECT_FALSE(scan.valid(4));  // beyond range_max_m
  auto next = lidar();
  next.utime += 25'000;
  EXPECT_EQ(seq_of(*translated(translator, "HOKUYO_FRONT", next)), 1);
  EXPECT_EQ(translator.num_bad(), 0);
}

TEST(BotCore, OfTwoScannersTheFirstUnlessOneIsChosen) {
  BotCoreTranslator first({}, 60000);
  EXPECT_TRUE(translated(first, "FRONT", lidar()));
  EXPECT_FALSE(translated(first, "REAR", lidar()));
  EXPECT_EQ(first.ignored().begin()->first,
            "REAR: a second channel of planar_lidar_t; choose one in section drivers.bot_core");
  device::BotCoreConfig config;
  config.scan_channel = "REAR";
  BotCoreTranslator chosen(config, 60000);
  EXPECT_FALSE(translated(chosen, "FRONT", lidar()));
  EXPECT_TRUE(translated(chosen, "REAR", lidar()));
}

TEST(BotCore, APoseAsAPosition) {
  device::BotCoreConfig config;
  config.pose_as = device::BotPoseAs::kPoseFix;
  BotCoreTranslator translator(config, 60000);
  const auto message = translated(translator, "POSE_BODY", pose(9, 3.0, -4.0, 2.1));
  ASSERT_TRUE(message);
  const auto& fix = std::get<pose::PoseFix>(*message);
  EXPECT_DOUBLE_EQ(fix.x_m, 3.0);
  EXPECT_DOUBLE_EQ(fix.y_m, -4.0);
  EXPECT_NEAR(fix.yaw_rad, 2.1, 1e-12);
  EXPECT_TRUE(fix.has_yaw);
}

// A robot that drives at 0.7 m/s along its own axis and turns at 0.3 rad/s, facing 2.1 rad.
TEST(BotCore, APoseAsVelocities) {
  BotCoreTranslator translator({}, 60000);
  bot_core::pose_t driving = pose(9, 3.0, -4.0, 2.1);
  driving.vel[0] = 0.7 * std::cos(2.1);
  driving.vel[1] = 0.7 * std::sin(2.1);
  driving.rotation_rate[2] = 0.3;
  const auto message = translated(translator, "POSE_BODY", driving);
  ASSERT_TRUE(message);
  const auto& odometry = std::get<pose::Odometry>(*message);
  EXPECT_EQ(odometry.utime, 9);
  EXPECT_NEAR(odometry.speed_mps, 0.7, 1e-12);
  EXPECT_NEAR(odometry.yaw_rate_radps, 0.3, 1e-12);
}

TEST(BotCore, VelocitiesOfARobotThatSendsPositionsAlone) {
  BotCoreTranslator translator({}, 60000);
  // On a circle of radius 2 at 0.2 rad/s: 0.4 m/s, through the turn of pi.
  const auto at = [](int i) {
    const double angle_rad = 2.9 + 0.2 * 0.1 * i;
    return pose(1'000'000 + 100'000 * i, 2 * std::sin(angle_rad), -2 * std::cos(angle_rad),
                angle_rad);
  };
  EXPECT_FALSE(translated(translator, "POSE", at(0)));
  for (int i = 1; i < 40; ++i) {
    const auto message = translated(translator, "POSE", at(i));
    ASSERT_TRUE(message) << i;
    const auto& odometry = std::get<pose::Odometry>(*message);
    EXPECT_EQ(odometry.utime, 1'000'000 + 100'000 * i);
    EXPECT_NEAR(odometry.speed_mps, 0.4, 1e-4);  // the chord
    EXPECT_NEAR(odometry.yaw_rate_radps, 0.2, 1e-9);
  }
  EXPECT_EQ(translator.num_bad(), 0);
}

TEST(BotCore, AFix) {
  BotCoreTranslator translator({}, 60000);
  bot_core::gps_data_t gps{};
  gps.utime = 8;
  gps.gps_lock = 3;
  gps.latitude = -32.4;
  gps.longitude = -71.3;
  gps.elev = 40.0;
  gps.horizontal_accuracy = 1.5;
  gps.vertical_accuracy = 3.0;
  const auto message = translated(translator, "GPS", gps);
  ASSERT_TRUE(message);
  const auto& gnss = std::get<pose::Gnss>(*message);
  EXPECT_EQ(gnss.latitude_deg, -32.4);
  EXPECT_EQ(gnss.longitude_deg, -71.3);
  EXPECT_EQ(gnss.covariance, (std::array<double, 6>{2.25, 0, 0, 2.25, 0, 9.0}));
  EXPECT_EQ(gnss.fix_quality, 1);
  gps.gps_lock = 0;
  EXPECT_FALSE(translated(translator, "GPS", gps));
  EXPECT_EQ(translator.num_bad(), 0);
}

TEST(BotCore, APicture) {
  BotCoreTranslator translator({}, 60000);
  const cv::Mat picture(48, 64, CV_8UC3, cv::Scalar(30, 60, 180));
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", picture, jpeg);
  const auto as_it_is = translated(translator, "CAMERA", image("MJPG", 64, 48, 0, jpeg));
  ASSERT_TRUE(as_it_is);
  EXPECT_EQ(std::get<vision::Image>(*as_it_is).data, jpeg);
  EXPECT_EQ(std::get<vision::Image>(*as_it_is).utime, 5);
  std::vector<std::uint8_t> padded;
  for (int row = 0; row < 48; ++row) {
    padded.insert(padded.end(), picture.ptr(row), picture.ptr(row) + 192);
    padded.resize(padded.size() + 8);
  }
  auto raw = image("BGR3", 64, 48, 200, padded);
  raw.utime = 6;
  const auto compressed = translated(translator, "CAMERA", raw);
  ASSERT_TRUE(compressed);
  const auto mean =
      cv::mean(cv::imdecode(std::get<vision::Image>(*compressed).data, cv::IMREAD_COLOR));
  EXPECT_NEAR(mean[0], 30, 3);
  EXPECT_NEAR(mean[2], 180, 3);
  EXPECT_FALSE(translated(translator, "CAMERA", image("BA81", 64, 48, 64, padded)));
  EXPECT_FALSE(translated(translator, "CAMERA", image("BGR3", 64, 480, 200, padded)));
  EXPECT_EQ(translator.num_bad(), 2);
}

TEST(BotCore, NothingIsTrusted) {
  BotCoreTranslator translator({}, 60000);
  EXPECT_FALSE(translator.translate("A", nullptr, 0));
  EXPECT_FALSE(translated(translator, "SCAN", orchard::scan_t{}));  // ours, not libbot's
  EXPECT_EQ(translator.num_bad(), 0);
  for (const auto& bytes : {encoded(lidar()), encoded(image("MJPG", 64, 48, 0, {1, 2, 3})),
                            encoded(pose(1, 2, 3, 4)), encoded(bot_core::gps_data_t{})}) {
    for (std::size_t size = 8; size < bytes.size(); ++size) {
      const auto decoded = decode_bot_core(bytes.data(), size);
      EXPECT_TRUE(std::holds_alternative<Rejection>(decoded)) << size;
    }
    ASSERT_TRUE(
        std::holds_alternative<BotCoreMessage>(decode_bot_core(bytes.data(), bytes.size())));
  }
  auto bytes = encoded(lidar());
  for (const std::uint8_t high : {0x7F, 0x80, 0xFF}) {  // counts of two milliards and below zero
    bytes[16] = high;
    EXPECT_FALSE(translator.translate("FRONT", bytes.data(), bytes.size()));
  }
  auto bad = lidar();
  bad.ranges[1] = -1.0f;
  EXPECT_FALSE(translated(translator, "FRONT", bad));
  bad = lidar();
  bad.radstep = NAN;
  EXPECT_FALSE(translated(translator, "FRONT", bad));
  bad = lidar();
  bad.utime = -5;
  EXPECT_FALSE(translated(translator, "FRONT", bad));
  bot_core::pose_t lying = pose(1, 2, 3, 0);
  lying.orientation[0] = 0.5;
  EXPECT_FALSE(translated(translator, "POSE", lying));
  EXPECT_EQ(translator.num_bad(), 7);
}

}  // namespace
}  // namespace orchard::bus
