// SPDX-License-Identifier: BSD-3-Clause
// A toy device whose protocol is lines of a speed, on a real socket and a real pseudo terminal.
#include <fcntl.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/driver/driver.hpp"
#include "bus/driver/port.hpp"
#include "bus/driver/source.hpp"
#include "bus/driver/stream_driver.hpp"

namespace orchard::bus {
namespace {

/// "hello" is answered by lines, each one a speed in m/s.
class ToyProtocol : public device::Protocol {
 public:
  void connected(std::int64_t host_utime) override {
    line_.clear();
    to_send_ = "hello\n";
    deadline_ = host_utime + 300000;
    failure_.clear();
  }
  void receive(std::string_view bytes, std::int64_t host_utime) override {
    deadline_ = host_utime + 300000;
    for (const char c : bytes) {
      if (c != '\n') {
        line_ += c;
        continue;
      }
      pose::Odometry odometry;
      odometry.utime = host_utime;
      odometry.speed_mps = std::stod(line_);
      measurements_.emplace_back(odometry);
      line_.clear();
    }
  }
  std::optional<std::int64_t> deadline() const override { return deadline_; }
  void expire(std::int64_t) override {
    deadline_.reset();
    failure_ = "silent";
  }
  void host_clock_stepped(std::int64_t) override {}
  std::string failure() const override { return failure_; }
  device::Condition condition() const override { return {}; }
  device::ProtocolCounts counts() const override { return {}; }

 private:
  std::string line_;
  std::string failure_;
  std::optional<std::int64_t> deadline_;
};

/// The device's end of a TCP connection.
class ToyServer {
 public:
  explicit ToyServer(std::uint16_t port = 0) {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int on = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(listen(listener_, 4), 0);
    socklen_t size = sizeof(address);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~ToyServer() {
    hang_up();
    close(listener_);
  }
  std::uint16_t port() const { return port_; }
  bool accept_one() {
    pollfd waiting{listener_, POLLIN, 0};
    if (poll(&waiting, 1, 0) <= 0) return false;
    hang_up();
    peer_ = accept(listener_, nullptr, nullptr);
    return peer_ >= 0;
  }
  void send_text(const std::string& text) {
    EXPECT_EQ(::send(peer_, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  void hang_up() {
    if (peer_ >= 0) close(peer_);
    peer_ = -1;
  }

 private:
  int listener_ = -1;
  int peer_ = -1;
  std::uint16_t port_ = 0;
};

/// Runs a driver's loop as LiveDriver does, until `done` or for a minute.
template <class Done>
bool run_until(Driver& driver, std::vector<Message>& out, Done done) {
  const auto end = Driver::Clock::now() + std::chrono::seconds(60);
  while (Driver::Clock::now() < end) {
    if (done()) return true;
    std::vector<pollfd> files = driver.files();
    const auto wait = std::min<Driver::Clock::duration>(driver.deadline() - Driver::Clock::now(),
                                                        std::chrono::milliseconds(5));
    const auto wait_ms = std::chrono::ceil<std::chrono::milliseconds>(wait).count();
    poll(files.data(), files.size(), static_cast<int>(std::max<std::int64_t>(0, wait_ms)));
    driver.step([&out](const Message& message) { out.push_back(message); });
  }
  return false;
}

PortAddress address_of(const ToyServer& server) {
  return parse_port("tcp:127.0.0.1:" + std::to_string(server.port()));
}

double speed_of(const Message& message) { return std::get<pose::Odometry>(message).speed_mps; }

TEST(PortAddress, IsReadAsAPersonWritesIt) {
  EXPECT_EQ(parse_port("tcp:192.168.0.10:10940").host, "192.168.0.10");
  EXPECT_EQ(parse_port("tcp:[::1]:7").host, "::1");
  EXPECT_EQ(parse_port("serial:/dev/ttyUSB0:57600").baud, 57600);
  EXPECT_EQ(parse_port("/dev/ttyACM0").path, "/dev/ttyACM0");
  EXPECT_EQ(parse_port("udp:2368").service, "2368");
  EXPECT_EQ(parse_port("udp:192.168.1.201:2368").host, "192.168.1.201");
  for (const char* bad :
       {"udp:", "udp:0", "udp::2368", "udp:host:2368", "udp:1.2.3.4", "udp:1.2.3.4:x"}) {
    EXPECT_THROW(parse_port(bad), std::invalid_argument) << bad;
  }
  for (const char* bad : {"", "tcp:", "tcp:host", "tcp::7", "tcp:h:0", "tcp:h:65536", "tcp:h:7x",
                          "serial:tty", "serial:/dev/x:12345", "usb:1"}) {
    EXPECT_THROW(parse_port(bad), std::invalid_argument) << bad;
  }
}

TEST(StreamDriver, ConnectsAgainAndNumbersOn) {
  ToyServer server;
  StreamDriver driver(std::make_unique<ToyProtocol>(), address_of(server));
  std::vector<Message> out;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(run_until(driver, out, [&] { return server.accept_one(); }));
    server.send_text("1.");
    server.send_text(std::to_string(i) + "\n");
    ASSERT_TRUE(run_until(driver, out, [&] { return out.size() == std::size_t(i) + 1; }));
    EXPECT_DOUBLE_EQ(speed_of(out.back()), 1.0 + 0.1 * i);
    EXPECT_EQ(seq_of(out.back()), i);
    EXPECT_EQ(driver.condition().level, Level::kOk);
    server.hang_up();
    ASSERT_TRUE(run_until(driver, out, [&] { return driver.condition().level == Level::kError; }));
    EXPECT_NE(driver.condition().text.find("retrying"), std::string::npos);
  }
}

TEST(StreamDriver, ASilentDeviceIsConnectedToAgain) {
  ToyServer server;
  StreamDriver driver(std::make_unique<ToyProtocol>(), address_of(server));
  std::vector<Message> out;
  ASSERT_TRUE(run_until(driver, out, [&] { return server.accept_one(); }));
  ASSERT_TRUE(run_until(driver, out, [&] { return server.accept_one(); }));  // 0.3 s later
}

TEST(StreamDriver, SaysWhatCannotBeOpened) {
  StreamDriver driver(std::make_unique<ToyProtocol>(), parse_port("/dev/no_such_device"));
  std::vector<Message> out;
  ASSERT_TRUE(run_until(driver, out, [&] {
    return !driver.condition().text.empty() &&
           driver.condition().text.find("plugged in") != std::string::npos;
  }));
}

TEST(StreamDriver, ASerialLineThatIsPulledOutAndPluggedInAgain) {
  const std::string link = testing::TempDir() + "/toy_tty";
  StreamDriver driver(std::make_unique<ToyProtocol>(), parse_port("serial:" + link));
  std::vector<Message> out;
  for (std::size_t i = 0; i < 3; ++i) {
    const int device = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_TRUE(device >= 0 && grantpt(device) == 0 && unlockpt(device) == 0);
    unlink(link.c_str());
    ASSERT_EQ(symlink(ptsname(device), link.c_str()), 0);
    char hello[16] = {};
    ASSERT_TRUE(run_until(driver, out, [&] { return read(device, hello, 6) == 6; }));
    EXPECT_STREQ(hello, "hello\n");
    ASSERT_EQ(write(device, "0.5\n", 4), 4);
    ASSERT_TRUE(run_until(driver, out, [&] { return out.size() == i + 1; }));
    close(device);
    ASSERT_TRUE(run_until(driver, out, [&] { return driver.condition().level == Level::kError; }));
  }
  unlink(link.c_str());
}

TEST(RawSource, GivesTheSameMeasurementsAgain) {
  const std::string path = testing::TempDir() + "/toy.raw";
  std::vector<Message> live;
  {
    ToyServer server;
    StreamDriver driver(std::make_unique<ToyProtocol>(), address_of(server), path);
    ASSERT_TRUE(run_until(driver, live, [&] { return server.accept_one(); }));
    server.send_text("0.1\n0.2\n0.");
    ASSERT_TRUE(run_until(driver, live, [&] { return live.size() == 2; }));
    server.send_text("3\n");
    ASSERT_TRUE(run_until(driver, live, [&] { return live.size() == 3; }));
  }
  RawSource source(std::make_unique<ToyProtocol>(), path);
  for (const Message& expected : live) {
    const auto message = source.next();
    ASSERT_TRUE(message);
    EXPECT_EQ(utime_of(*message), utime_of(expected));
    EXPECT_EQ(seq_of(*message), seq_of(expected));
    EXPECT_EQ(speed_of(*message), speed_of(expected));
  }
  EXPECT_FALSE(source.next());
}

TEST(HostClock, RunsWithTheTimeOfDayAndSeesNoStepWhereThereIsNone) {
  HostClock clock;
  const std::int64_t first = clock.now();
  EXPECT_NEAR(static_cast<double>(first), static_cast<double>(time(nullptr)) * 1e6, 2e6);
  for (int i = 0; i < 1000; ++i) clock.now();
  EXPECT_GE(clock.now(), first);
  EXPECT_EQ(clock.take_step(), 0);
}

}  // namespace
}  // namespace orchard::bus
