// SPDX-License-Identifier: BSD-3-Clause
// The filter alone, on a pair of plain sockets: which datagrams it lets through.
#include "bus/socket_guard.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

namespace orchard::bus {
namespace {

std::string u32(std::uint32_t value) {
  const std::uint32_t big = htonl(value);
  return {reinterpret_cast<const char*>(&big), sizeof(big)};
}

std::string u16(std::uint16_t value) {
  const std::uint16_t big = htons(value);
  return {reinterpret_cast<const char*>(&big), sizeof(big)};
}

std::string whole(const std::string& rest) { return u32(0x4c433032) + u32(7) + rest; }

std::string fragment(std::uint32_t size, std::uint32_t offset, std::uint16_t number,
                     const std::string& rest) {
  return u32(0x4c433033) + u32(7) + u32(size) + u32(offset) + u16(number) + u16(3) + rest;
}

/// A name as it stands in a datagram, with its zero.
std::string named(std::size_t length) { return std::string(length, 'A') + '\0'; }

class SocketGuardTest : public ::testing::Test {
 protected:
  SocketGuardTest() : to_(socket(AF_INET, SOCK_DGRAM, 0)), from_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    bind(to_, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
    socklen_t size = sizeof(address);
    getsockname(to_, reinterpret_cast<sockaddr*>(&address), &size);
    usable_ = connect(from_, reinterpret_cast<const sockaddr*>(&address), size) == 0;
  }
  ~SocketGuardTest() override {
    close(to_);
    close(from_);
  }

  /// Over the loopback a datagram is there when send() returns, or it was dropped.
  bool passes(const std::string& datagram) const {
    send(from_, datagram.data(), datagram.size(), 0);
    char bytes[70000];
    return recv(to_, bytes, sizeof(bytes), MSG_DONTWAIT) >= 0;
  }

  SocketGuard before_;  // only the socket opened after it is guarded
  int to_;
  int from_;
  bool usable_ = false;
};

TEST_F(SocketGuardTest, PassesWhatLcmSends) {
  if (!usable_) GTEST_SKIP() << "no loopback here";
  ASSERT_EQ(before_.attach(), 2);
  EXPECT_TRUE(passes(whole(named(4) + "payload")));
  EXPECT_TRUE(passes(whole(named(63))));
  EXPECT_TRUE(passes(whole(named(4) + std::string(60000, 'x'))));
  EXPECT_TRUE(passes(fragment(230000, 0, 0, named(5) + std::string(60000, 'x'))));
  EXPECT_TRUE(passes(fragment(230000, 180000, 3, std::string(50000, 'A'))));
  EXPECT_TRUE(passes(fragment(16 << 20, (16 << 20) - 1, 9, "A")));
}

TEST_F(SocketGuardTest, DropsWhatLcmDoesNotSurvive) {
  if (!usable_) GTEST_SKIP() << "no loopback here";
  ASSERT_EQ(before_.attach(), 2);
  const std::string refused[] = {
      "",
      "L",
      "LC02",
      "LC03",
      u32(0x4c433034) + u32(7) + named(4) + "other magic",
      whole(""),
      whole("SCAN"),                 // the name does not end
      whole(named(64) + "payload"),  // nor does it within LCM's limit
      whole(std::string(200, 'A')),
      fragment(3000, 0, 0, "SC"),
      fragment(3000, 0, 0, std::string(900, 'A')),
      fragment((16 << 20) + 1, 0, 0, named(4) + "x"),
      fragment(0xFFFFFFFF, 0, 0, named(4) + "x"),
      fragment(3000, 0xFFFFFFF0, 1, std::string(900, 'x')),  // wraps
      fragment(3000, (16 << 20) + 1, 1, "x"),
      fragment(3000, 0, 0, "").substr(0, 17),
  };
  for (const std::string& datagram : refused) EXPECT_FALSE(passes(datagram)) << datagram.size();
  EXPECT_EQ(before_.num_dropped(), static_cast<std::int64_t>(std::size(refused)));
  EXPECT_TRUE(passes(whole(named(4) + "payload"))) << "and goes on";
}

TEST_F(SocketGuardTest, PassesOnlyTheChannelsThatAreListenedTo) {
  if (!usable_) GTEST_SKIP() << "no loopback here";
  ASSERT_EQ(before_.attach(), 2);
  const std::string body(8, 'x');  // the least that a message of LCM has
  const auto message = [&body](const std::string& channel) {
    return whole(channel + std::string(1, '\0') + body);
  };
  before_.listen_to({"SCAN.rear", "POSE_FIX", "SCAN", "MAP"});
  for (const char* wanted : {"SCAN", "SCAN.rear", "POSE_FIX", "MAP"}) {
    EXPECT_TRUE(passes(message(wanted))) << wanted;
  }
  const std::string others[] = {"",         "S",          "SCA",  "SCANS",
                                "SCAN.rea", "SCAN.rears", "POSE", "POSE_FIX2",
                                "IMAGE",    "MAPS",       "xMAP", std::string(62, 'M')};
  for (const std::string& other : others) EXPECT_FALSE(passes(message(other))) << other;
  EXPECT_FALSE(passes(whole("SCAN")));
  EXPECT_FALSE(passes(fragment(3000, 0xFFFFFFF0, 1, std::string(900, 'x')))) << "still guarded";
  EXPECT_TRUE(passes(fragment(230000, 180000, 3, std::string(50000, 'A')))) << "names no channel";
  before_.listen_to({"IMAGE"});
  EXPECT_FALSE(passes(message("SCAN")));
  EXPECT_TRUE(passes(message("IMAGE")));
  before_.listen_to({});
  EXPECT_FALSE(passes(message("IMAGE")));
}

TEST(SocketGuard, LeavesTheSocketsOfOthersAlone) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  SocketGuard guard;
  EXPECT_EQ(guard.attach(), 0);
  close(fd);
}

}  // namespace
}  // namespace orchard::bus
