// SPDX-License-Identifier: BSD-3-Clause
// The driver of a VLP-16 on a real UDP port, to which an emulated scanner and others send.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "bus/driver/source.hpp"
#include "bus/driver/stream_driver.hpp"
#include "device/laser_protocol.hpp"
#include "unit/device/emulated_vlp16.hpp"

namespace orchard::bus {
namespace {

sockaddr_in loopback(std::uint32_t last, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK + last);
  address.sin_port = htons(port);
  return address;
}

/// A socket of 127.0.0.1 + `last`, from which datagrams are sent.
class Sender {
 public:
  explicit Sender(std::uint32_t last = 0) : file_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address = loopback(last, 0);
    EXPECT_EQ(bind(file_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    socklen_t size = sizeof(address);
    getsockname(file_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~Sender() { close(file_); }
  std::uint16_t port() const { return port_; }
  void send_to(std::uint16_t port, const std::string& bytes) const {
    const sockaddr_in to = loopback(0, port);
    EXPECT_EQ(sendto(file_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                     sizeof(to)),
              static_cast<ssize_t>(bytes.size()));
  }

 private:
  int file_;
  std::uint16_t port_ = 0;
};

std::uint16_t free_port() { return Sender().port(); }

device::LaserDriverConfig config_of(const std::string& where) {
  device::LaserDriverConfig config;
  config.device = where;
  config.protocol = device::LaserProtocol::kVelodyne;
  config.scanner_height_m = 1.0;
  return config;
}

test::EmulatedVlp16 in_orchard() {
  test::EmulatedVlp16 scanner;
  scanner.orchard.cylinders = {{3.0, 0.0, 0.05}, {-4.0, 2.5, 0.1}};
  return scanner;
}

class VelodyneDriver : public testing::Test {
 protected:
  explicit VelodyneDriver(const std::string& host = "")
      : port_(free_port()),
        driver_(device::make_laser_protocol(config_of("")),
                parse_port("udp:" + host + std::to_string(port_)), raw_path()) {
    step();  // opens the port
  }
  static std::string raw_path() { return testing::TempDir() + "/vlp16.raw"; }

  void step() {
    std::vector<pollfd> files = driver_.files();
    poll(files.data(), files.size(), 1);
    driver_.step(
        [this](const Message& message) { scans_.push_back(std::get<laser::Scan>(message)); });
  }
  /// Lets the driver work until `done` or for a minute.
  template <class Done>
  bool run_until(Done done) {
    const auto end = Driver::Clock::now() + std::chrono::seconds(60);
    while (!done() && Driver::Clock::now() < end) step();
    return done();
  }
  void send(const std::string& bytes) {
    sender_.send_to(port_, bytes);
    step();
  }
  std::string text() const { return driver_.condition().text; }

  std::uint16_t port_;
  Sender sender_;
  StreamDriver driver_;
  std::vector<laser::Scan> scans_;
};

class VelodyneDriverOfOne : public VelodyneDriver {
 protected:
  VelodyneDriverOfOne() : VelodyneDriver("127.0.0.9:") {}
};

TEST_F(VelodyneDriver, DatagramsBecomeScansAndTheirRecordingTheSame) {
  const test::EmulatedVlp16 scanner = in_orchard();
  for (int i = 0; i < 320; ++i) send(scanner.packet(i));
  ASSERT_TRUE(run_until([&] { return scans_.size() >= 3; }));
  EXPECT_EQ(scans_[2].seq, 2);
  EXPECT_NEAR(scans_[1].ranges_m[904], 2.95, 0.003);
  EXPECT_EQ(driver_.condition().level, Level::kOk);
  RawSource again(device::make_laser_protocol(config_of("")), raw_path());
  for (const laser::Scan& scan : scans_) {
    const auto message = again.next();
    ASSERT_TRUE(message);
    EXPECT_EQ(std::get<laser::Scan>(*message).utime, scan.utime);
  }
}

TEST_F(VelodyneDriver, LossesDisorderDoublesAndGarbageCostNoScan) {
  test::EmulatedVlp16 scanner = in_orchard();
  scanner.returns = test::EmulatedVlp16::kDual;
  for (int i = 0; i < 800; ++i) {
    if (i % 40 == 7) continue;
    const int number = i % 40 == 20 ? i + 1 : i % 40 == 21 ? i - 1 : i;
    send(scanner.packet(number));
    if (i % 40 == 30) send(scanner.packet(number));
    if (i % 40 == 32) send("garbage");
    if (i % 40 == 33) send("");
  }
  ASSERT_TRUE(run_until([&] { return scans_.size() >= 4; }));
  EXPECT_EQ(driver_.condition().level, Level::kWarning);
  EXPECT_NE(text().find("packets refused in 10 s"), std::string::npos) << text();
  for (const laser::Scan& scan : scans_) EXPECT_NEAR(scan.ranges_m[904], 2.95, 0.003);
}

TEST_F(VelodyneDriver, NothingOnThePortIsAnErrorThatSaysWhatToCheck) {
  ASSERT_TRUE(run_until([&] { return driver_.condition().level == Level::kError; }));
  EXPECT_NE(text().find("no packet arrives"), std::string::npos) << text();
  EXPECT_NE(text().find("to this port"), std::string::npos) << text();
  send(std::string(512, '\0'));
  ASSERT_TRUE(run_until([&] { return text().find("8308") != std::string::npos; }));
  EXPECT_EQ(driver_.condition().level, Level::kError);
  const test::EmulatedVlp16 scanner = in_orchard();
  for (int i = 0; i < 320; ++i) send(scanner.packet(i));
  EXPECT_TRUE(run_until([&] { return !scans_.empty(); }));
}

TEST_F(VelodyneDriver, APortInUseIsNamed) {
  StreamDriver second(device::make_laser_protocol(config_of("")),
                      parse_port("udp:" + std::to_string(port_)));
  second.step([](const Message&) {});
  EXPECT_EQ(second.condition().level, Level::kError);
  EXPECT_NE(second.condition().text.find("another program receives on this port"),
            std::string::npos);
}

TEST_F(VelodyneDriverOfOne, OtherSendersAreLeftOutAndNamed) {
  const test::EmulatedVlp16 scanner = in_orchard();
  for (int i = 0; i < 320; ++i) send(scanner.packet(i));
  ASSERT_TRUE(run_until([&] { return driver_.condition().level == Level::kError; }));
  EXPECT_TRUE(scans_.empty());
  EXPECT_NE(text().find("127.0.0.1 sends to this port too"), std::string::npos) << text();
  const Sender right(8);
  for (int i = 0; i < 320; ++i) {
    right.send_to(port_, scanner.packet(i));
    step();
  }
  EXPECT_TRUE(run_until([&] { return !scans_.empty(); }));
}

}  // namespace
}  // namespace orchard::bus
