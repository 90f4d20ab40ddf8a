// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/service_messages.hpp"

#include <gtest/gtest.h>

namespace orchard::bus {
namespace {

Status sample_status() {
  Status status;
  status.utime = 1700000000000000;
  status.seq = 5;
  status.level = Level::kWarning;
  status.num_good = 10;
  status.latency_max_s = 0.25;
  status.name = "orchard-detector";
  status.host = "robot";
  status.text = "waits";
  return status;
}

const Ack kAckSample{1700000000000000, 4, 2, Channel::kDetections, {{Channel::kMap, 9}}};

/// Every truncation, extension and flipped bit is refused or decodes; none crashes.
template <class Decode>
void expect_survives(const std::vector<std::uint8_t>& bytes, Decode decode) {
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + size);
    EXPECT_TRUE(std::holds_alternative<Rejection>(decode(cut.data(), cut.size()))) << size;
  }
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    std::vector<std::uint8_t> flipped = bytes;
    flipped[i / 8] ^= static_cast<std::uint8_t>(1 << i % 8);
    decode(flipped.data(), flipped.size());
  }
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode(longer.data(), longer.size())));
}

TEST(ServiceMessages, StatusRoundTrip) {
  const auto bytes = encode(sample_status());
  const auto status = std::get<Status>(decode_status(bytes.data(), bytes.size()));
  EXPECT_EQ(encode(status), bytes);
  EXPECT_EQ(status.text, "waits");
  EXPECT_EQ(status.level, Level::kWarning);
  expect_survives(bytes, decode_status);
}

TEST(ServiceMessages, ConfigRoundTrip) {
  const auto bytes = encode(ConfigNotice{17, 1, -5, "orchard-pose", "0.1.0", "lcm:\n  url: x\n"});
  const auto notice = std::get<ConfigNotice>(decode_config(bytes.data(), bytes.size()));
  EXPECT_EQ(notice.hash, -5);
  EXPECT_EQ(notice.text, "lcm:\n  url: x\n");
  expect_survives(bytes, decode_config);
}

TEST(ServiceMessages, AckRoundTrip) {
  const auto bytes = encode(kAckSample);
  const auto ack = std::get<Ack>(decode_ack(bytes.data(), bytes.size()));
  EXPECT_EQ(ack.node, 2);
  ASSERT_EQ(ack.outputs.size(), 1u);
  EXPECT_EQ(ack.outputs[0].channel, Channel::kMap);
  EXPECT_EQ(ack.outputs[0].seq, 9);
  expect_survives(bytes, decode_ack);
}

TEST(ServiceMessages, AckOfAnUnknownNodeOrChannelIsRefused) {
  Ack ack = kAckSample;
  ack.node = 3;
  auto bytes = encode(ack);
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_ack(bytes.data(), bytes.size())));
  ack = kAckSample;
  ack.outputs[0].channel = static_cast<Channel>(kNumChannels);
  bytes = encode(ack);
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_ack(bytes.data(), bytes.size())));
}

TEST(ServiceMessages, ReplayRoundTrip) {
  const auto bytes = encode(ReplayMark{17, 2, true});
  const auto mark = std::get<ReplayMark>(decode_replay(bytes.data(), bytes.size()));
  EXPECT_TRUE(mark.end);
  EXPECT_EQ(mark.seq, 2);
  expect_survives(bytes, decode_replay);
}

TEST(ServiceMessages, StringOfLengthZeroIsRefused) {
  // The generated decoder would make a string of -1 bytes of it.
  Status status = sample_status();
  status.name.clear();
  auto bytes = encode(status);
  bytes[93 + 3] = 0;
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_status(bytes.data(), bytes.size())));
}

TEST(ServiceMessages, StringWithAZeroInsideIsRefused) {
  auto bytes = encode(sample_status());
  bytes[93 + 4 + 3] = 0;
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_status(bytes.data(), bytes.size())));
}

}  // namespace
}  // namespace orchard::bus
