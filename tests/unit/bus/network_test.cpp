// SPDX-License-Identifier: BSD-3-Clause
#include "bus/network.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/messages/channel.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

TEST(Network, TheRobotIsTakenOutOfTheUrl) {
  const Network plain = parse_network("udpm://239.255.76.67:7667?ttl=1&recv_buf_size=4194304");
  EXPECT_EQ(plain.lcm_url, "udpm://239.255.76.67:7667?ttl=1&recv_buf_size=4194304");
  EXPECT_EQ(plain.robot, "");
  for (const char* url : {"udpm://239.255.76.67:7667?ttl=1&robot=koala&recv_buf_size=1",
                          "udpm://239.255.76.67:7667?robot=koala;ttl=1&recv_buf_size=1",
                          "udpm://239.255.76.67:7667?ttl=1&recv_buf_size=1&robot=koala"}) {
    EXPECT_EQ(parse_network(url).lcm_url, "udpm://239.255.76.67:7667?ttl=1&recv_buf_size=1") << url;
    EXPECT_EQ(parse_network(url).robot, "koala") << url;
  }
  EXPECT_EQ(parse_network("memq://?robot=a").lcm_url, "memq://");
}

TEST(Network, BadNamesAreRefused) {
  for (const char* name :
       {"", "a b", "a/b", "..", "k\xc3\xb6nig", "a&robot=b", "more-than-thirty-two-letters-long"}) {
    EXPECT_THROW(parse_network(std::string("memq://?robot=") + name), std::invalid_argument)
        << name;
    EXPECT_THROW(Bus(std::string("memq://?robot=") + name), BusError) << name;
  }
}

TEST(Network, ANewNameReplacesTheOldOne) {
  EXPECT_EQ(with_robot("udpm://", "koala"), "udpm://?robot=koala");
  EXPECT_EQ(with_robot("udpm://?ttl=1", "koala"), "udpm://?ttl=1&robot=koala");
  EXPECT_EQ(with_robot("udpm://?robot=heron&ttl=1", "koala"), "udpm://?ttl=1&robot=koala");
  EXPECT_EQ(with_robot("udpm://?robot=heron", ""), "udpm://?robot=heron");
}

TEST(Network, EveryChannelOfTheLongestNameFitsLcm) {
  const std::string longest(32, 'r');
  for (const ChannelInfo& channel : kChannels) {
    const std::string name = longest + "/" + std::string(channel.name);
    EXPECT_LE(name.size(), 63u);
    EXPECT_EQ(split_robot(name).robot, longest);
    EXPECT_EQ(split_robot(name).name, channel.name);
  }
}

TEST(Network, OnlyKnownChannelsBelongToARobot) {
  for (const char* name : {"SCAN", "koala/ARM", "a b/SCAN", "../SCAN", "/SCAN", "koala/x/SCAN"}) {
    EXPECT_EQ(split_robot(name).robot, "") << name;
    EXPECT_EQ(split_robot(name).name, name);
    EXPECT_NO_THROW(require_no_robot(name, "a.lcm")) << name;
  }
  EXPECT_THROW(require_no_robot("koala/SCAN.rear", "a.lcm"), io::FileError);
}

TEST(Network, ARecorderOfARobotWritesItsChannelsWithoutItsName) {
  Bus bus("memq://?robot=koala");
  std::vector<std::string> heard;
  bus.subscribe_raw(
      [&](const std::string& channel, std::int64_t, Bytes) { heard.push_back(channel); });
  bus.publish(Channel::kScanRear, {1, 2, 3});
  bus.handle(100);
  EXPECT_EQ(heard, std::vector<std::string>{"SCAN.rear"});
}

}  // namespace
}  // namespace orchard::bus
