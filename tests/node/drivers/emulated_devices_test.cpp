// SPDX-License-Identifier: BSD-3-Clause
// Drivers and what plays their devices, over a real pseudo terminal and a real TCP connection: what
// comes out is what the log holds.
#include <gtest/gtest.h>
#include <poll.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "bus/driver/device_server.hpp"
#include "bus/driver/port.hpp"
#include "bus/driver/source.hpp"
#include "bus/driver/stream_driver.hpp"
#include "bus/messages/codec.hpp"
#include "device/emulated/emulated_lines.hpp"
#include "device/gnss/gpsd_protocol.hpp"
#include "device/lines/controller_protocol.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::bus {
namespace {

using Clock = Driver::Clock;
constexpr std::int64_t kEpoch_us = 1'767'225'600'000'000;

/// A log in a folder of its own, removed at the end.
class EmulatedDevices : public ::testing::Test {
 protected:
  EmulatedDevices() {
    folder_ =
        std::filesystem::temp_directory_path() / ("orchard_emulated_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~EmulatedDevices() override { std::filesystem::remove_all(folder_); }

  void write_log(const std::vector<Message>& messages) {
    log_path_ = (folder_ / "drive.lcm").string();
    io::LogWriter writer(log_path_);
    for (const Message& message : messages) {
      writer.write(utime_of(message), info(channel_of(message)).name, encode(message));
    }
    writer.close();
  }

  /// Runs driver and emulator in one loop until the last message came or a minute has passed.
  static std::vector<Message> run(PlayedLog log, DeviceServer& server, Driver& driver,
                                  const std::function<bool(const Message&)>& is_last) {
    std::vector<Message> messages;
    const auto give_up = Clock::now() + std::chrono::minutes(1);
    while ((messages.empty() || !is_last(messages.back())) && Clock::now() < give_up) {
      std::vector<pollfd> files = driver.files();
      for (const pollfd& file : server.files()) files.push_back(file);
      const auto until = std::min({driver.deadline(), server.deadline(), log.deadline(), give_up});
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
      poll(files.data(), files.size(), static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
      while (const auto message = log.take_due()) {
        if (const auto* odometry = std::get_if<pose::Odometry>(&*message)) {
          server.measured(*odometry);
        } else if (const auto* gnss = std::get_if<pose::Gnss>(&*message)) {
          server.measured(*gnss);
        } else if (const auto* imu = std::get_if<pose::Imu>(&*message)) {
          server.measured(*imu);
        }
      }
      server.step();
      driver.step([&messages](Message message) { messages.push_back(std::move(message)); });
    }
    return messages;
  }

  std::filesystem::path folder_;
  std::string log_path_;
};

TEST_F(EmulatedDevices, OdometryLinesOverAPseudoTerminal) {
  std::vector<Message> sent;
  for (int i = 0; i < 60; ++i) {
    pose::Odometry odometry;
    // The first ones are played before the driver is there; the rest at 50 Hz.
    odometry.utime = kEpoch_us + (i < 10 ? 0 : 1'000'000) + 20'000 * i;
    odometry.seq = i;
    odometry.speed_mps = 0.5 + 0.001 * i;
    odometry.yaw_rate_radps = -0.01 * i;
    sent.push_back(odometry);
  }
  write_log(sent);
  DeviceServer server(std::make_unique<device::ControllerDevice>(device::EmulatedClock{}), "pty:");
  StreamDriver driver(std::make_unique<device::ControllerProtocol>(device::OdometryDriverConfig{},
                                                                   device::ImuDriverConfig{}),
                      parse_port(server.address()));
  const auto received = run(
      PlayedLog(log_path_, 0, {Channel::kOdometry}), server, driver,
      [](const Message& message) { return std::get<pose::Odometry>(message).speed_mps > 0.5585; });
  ASSERT_GE(received.size(), 49u);  // the first line of a connection is half a line
  std::int64_t last_utime = 0;
  for (std::size_t i = 0; i < received.size(); ++i) {
    const auto& odometry = std::get<pose::Odometry>(received[i]);
    const auto& truth = std::get<pose::Odometry>(sent[sent.size() - received.size() + i]);
    EXPECT_EQ(odometry.seq, static_cast<int>(i));
    EXPECT_NEAR(odometry.speed_mps, truth.speed_mps, 1e-8);
    EXPECT_NEAR(odometry.yaw_rate_radps, truth.yaw_rate_radps, 1e-8);
    EXPECT_GT(odometry.utime, last_utime);
    last_utime = odometry.utime;
  }
  EXPECT_EQ(driver.condition().num_bad, 0);
  EXPECT_EQ(driver.condition().text, "");
}

TEST_F(EmulatedDevices, FixesOverTcp) {
  std::vector<Message> sent;
  for (int i = 0; i < 12; ++i) {
    pose::Gnss gnss;
    gnss.utime = kEpoch_us + 1'000'000 + 100'000 * i;
    gnss.latitude_deg = -32.4 + 1e-7 * i;
    gnss.longitude_deg = -71.3 - 2e-7 * i;
    gnss.altitude_m = 51.5;
    gnss.covariance = {4e-4, 1e-4, 0.0, 9e-4, 0.0, 25e-4};
    gnss.fix_quality = static_cast<std::int8_t>(i % 2 == 0 ? 4 : 5);
    sent.push_back(gnss);
  }
  pose::Odometry first;
  first.utime = kEpoch_us;
  sent.insert(sent.begin(), first);
  write_log(sent);
  DeviceServer server(std::make_unique<device::GpsdDevice>(0.05), "tcp:127.0.0.1:0");
  device::GnssDriverConfig config;
  config.latency_s = 0.05;
  StreamDriver driver(std::make_unique<device::GpsdProtocol>(config), parse_port(server.address()));
  const auto received =
      run(PlayedLog(log_path_, 0, {Channel::kGnss}), server, driver,
          [](const Message& message) { return std::get<pose::Gnss>(message).seq == 11; });
  ASSERT_EQ(received.size(), 12u);
  for (std::size_t i = 0; i < received.size(); ++i) {
    const auto& gnss = std::get<pose::Gnss>(received[i]);
    const auto& truth = std::get<pose::Gnss>(sent[i + 1]);
    EXPECT_NEAR(gnss.latitude_deg, truth.latitude_deg, 1e-9);
    EXPECT_NEAR(gnss.longitude_deg, truth.longitude_deg, 1e-9);
    EXPECT_NEAR(gnss.altitude_m, truth.altitude_m, 1e-3);
    EXPECT_EQ(gnss.fix_quality, truth.fix_quality);
    for (std::size_t k : {0u, 1u, 3u, 5u}) {
      EXPECT_NEAR(gnss.covariance[k], truth.covariance[k], 1e-6) << k;
    }
  }
}

TEST_F(EmulatedDevices, AnInertialUnitOverAPseudoTerminal) {
  std::vector<Message> sent;
  for (int i = 0; i < 20; ++i) {
    pose::Imu imu;
    imu.utime = kEpoch_us + (i == 0 ? 0 : 1'000'000) + 10'000 * i;
    imu.angular_rate_radps = {0.01, -0.02, 0.001 * i};
    imu.acceleration_mps2 = {0.1, 0.2, 9.8};
    sent.push_back(imu);
  }
  write_log(sent);
  DeviceServer server(std::make_unique<device::ControllerDevice>(device::EmulatedClock{}), "pty:");
  StreamDriver driver(std::make_unique<device::ControllerProtocol>(device::OdometryDriverConfig{},
                                                                   device::ImuDriverConfig{}),
                      parse_port(server.address()));
  const auto received =
      run(PlayedLog(log_path_, 0, {Channel::kImu}), server, driver, [](const Message& message) {
        return std::get<pose::Imu>(message).angular_rate_radps[2] > 0.0185;
      });
  ASSERT_GE(received.size(), 18u);
  EXPECT_NEAR(std::get<pose::Imu>(received.back()).angular_rate_radps[2], 0.019, 1e-9);
  EXPECT_NEAR(std::get<pose::Imu>(received.back()).acceleration_mps2[2], 9.8, 1e-7);
}

}  // namespace
}  // namespace orchard::bus
