// SPDX-License-Identifier: BSD-3-Clause
// Scanners' drivers over TCP and a pseudo terminal. How quick and how exact they are is measured by
// tests/experiments/laser_driver_figures; here only that it works, whatever the host does.
#include "bus/driver/source.hpp"
#include "bus/node/process_report.hpp"
#include "device/cola/cola_protocol.hpp"
#include "device/emulated/emulated_laser.hpp"
#include "device/scip/scip_protocol.hpp"
#include "node/drivers/driven_laser.hpp"

namespace orchard {
namespace {

std::unique_ptr<device::EmulatedDevice> hokuyo(std::int64_t on_for_us = 60'000'000) {
  device::EmulatedClock clock;
  clock.start_utime = bus::wall_utime() - on_for_us;
  return std::make_unique<device::ScipDevice>(device::ust_10lx(), clock);
}

std::unique_ptr<device::EmulatedDevice> sick(bool is_binary) {
  device::ColaDeviceModel model;
  model.rate_hz = 40.0;
  model.is_binary = is_binary;
  device::EmulatedClock clock;
  clock.start_utime = bus::wall_utime() - 60'000'000;
  return std::make_unique<device::ColaDevice>(model, clock);
}

std::string link_in_temp(const std::string& name) { return testing::TempDir() + "/" + name; }

/// Every scan is of a sweep that was measured, in order, and stamped about when that was.
void expect_true(const DrivenLaser& laser) {
  std::int32_t seq = 0;
  for (const laser::Scan& scan : laser.scans()) {
    EXPECT_EQ(scan.seq, seq++);
    EXPECT_EQ(scan.ranges_m.size(), 1081u);
    EXPECT_NEAR(static_cast<double>(scan.utime), static_cast<double>(laser.true_utime(scan)), 1e6);
  }
}

TEST(LaserDriver, HokuyoOverTcpIsUnpluggedAndPluggedIn) {
  DrivenLaser laser(std::make_unique<device::ScipProtocol>(), hokuyo(), "tcp:127.0.0.1:0",
                    field_scanner());
  for (int i = 0; i < 3; ++i) {
    const std::size_t before = laser.scans().size();
    ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= before + 10; }));
    EXPECT_EQ(laser.driver().condition().level, bus::Level::kOk);
    laser.server().unplug();
    ASSERT_TRUE(
        laser.run_until([&] { return laser.driver().condition().level == bus::Level::kError; }));
    laser.server().plug_in();
  }
  expect_true(laser);
}

TEST(LaserDriver, HokuyoOnAPseudoTerminalIsUnpluggedAndPluggedInWithItsPowerCut) {
  DrivenLaser laser(std::make_unique<device::ScipProtocol>(), hokuyo(),
                    "pty:" + link_in_temp("hokuyo_tty"), field_scanner());
  for (int i = 0; i < 3; ++i) {
    const std::size_t before = laser.scans().size();
    ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= before + 10; }));
    laser.server().unplug();
    ASSERT_TRUE(
        laser.run_until([&] { return laser.driver().condition().level == bus::Level::kError; }));
    laser.server().replace(hokuyo(0));
    laser.server().plug_in();
  }
  expect_true(laser);
}

TEST(LaserDriver, SickOverTcpIsUnpluggedAndPluggedIn) {
  DrivenLaser laser(std::make_unique<device::ColaProtocol>(), sick(false), "tcp:127.0.0.1:0",
                    field_scanner());
  for (int i = 0; i < 3; ++i) {
    const std::size_t before = laser.scans().size();
    ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= before + 10; }));
    EXPECT_EQ(laser.driver().condition().level, bus::Level::kOk);
    EXPECT_EQ(laser.driver().condition().text.substr(0, 6), i == 0 ? "CoLa-A" : "CoLa-B");
    laser.server().unplug();
    laser.server().replace(sick(true));  // somebody has changed it with the maker's program
    ASSERT_TRUE(
        laser.run_until([&] { return laser.driver().condition().level == bus::Level::kError; }));
    laser.server().plug_in();
  }
  expect_true(laser);
}

TEST(LaserDriver, AScannerThatStopsSendingIsStartedAgain) {
  DrivenLaser laser(std::make_unique<device::ScipProtocol>(), hokuyo(), "tcp:127.0.0.1:0",
                    field_scanner());
  ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= 10; }));
  laser.server().replace(hokuyo(0));  // it was reset, and waits for a command on the same line
  const std::size_t before = laser.scans().size();
  ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= before + 10; }));
  expect_true(laser);
}

TEST(LaserDriver, RecordedBytesGiveTheSameScansAgain) {
  const std::string raw = link_in_temp("hokuyo.raw");
  std::vector<laser::Scan> live;
  {
    DrivenLaser laser(std::make_unique<device::ScipProtocol>(), hokuyo(), "tcp:127.0.0.1:0",
                      field_scanner(), raw);
    ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= 20; }));
    // The scanner's silence is over before the driver could notice it: it was not silent.
    laser.hold_up(std::chrono::milliseconds(1500));
    ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= 90; }));
    // Its reset is noticed, and it is started again.
    laser.server().replace(hokuyo(0));
    ASSERT_TRUE(laser.run_until([&] { return laser.scans().size() >= 110; }));
    live = laser.scans();
  }
  bus::RawSource source(std::make_unique<device::ScipProtocol>(), raw);
  for (const laser::Scan& expected : live) {
    const auto message = source.next();
    ASSERT_TRUE(message);
    const auto& scan = std::get<laser::Scan>(*message);
    EXPECT_EQ(scan.utime, expected.utime);
    EXPECT_EQ(scan.seq, expected.seq);
    EXPECT_EQ(scan.ranges_m, expected.ranges_m);
  }
}

}  // namespace
}  // namespace orchard
