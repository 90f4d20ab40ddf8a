// SPDX-License-Identifier: BSD-3-Clause
#include "bus/bus.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "node/bus/fake_log.hpp"

namespace orchard::bus {
namespace {

TEST(Bus, DeliversWhatWasSent) {
  Bus bus("memq://");
  std::vector<std::int32_t> seqs;
  bus.subscribe(Channel::kScan, [&](const Message& m, Bytes) { seqs.push_back(seq_of(m)); });
  for (const Message& message : testing::fake_drive(100)) bus.publish(message);
  while (bus.handle(0)) {
  }
  ASSERT_EQ(seqs.size(), 100u);  // more than LCM's default queue of 30
  EXPECT_EQ(seqs.back(), 99);
  EXPECT_EQ(bus.counts().num_good, 100);
  EXPECT_EQ(bus.counts().num_bad(), 0);
}

TEST(Bus, RefusesAndCountsByReason) {
  Bus bus("memq://");
  int num_handled = 0;
  std::vector<Reason> reasons;
  bus.subscribe(Channel::kScan, [&](const Message&, Bytes) { ++num_handled; });
  bus.on_rejection([&](Channel, const Rejection& r) { reasons.push_back(r.reason); });
  std::vector<std::uint8_t> bytes = encode(testing::fake_drive(1)[0]);
  bus.publish(Channel::kScan, {1, 2, 3});
  bus.publish(Channel::kScan, encode(testing::fake_drive(1)[1]));
  bytes[20] = 0xFF;
  bus.publish(Channel::kScan, bytes);
  while (bus.handle(0)) {
  }
  EXPECT_EQ(num_handled, 0);
  EXPECT_EQ(reasons,
            (std::vector<Reason>{Reason::kTooShort, Reason::kWrongType, Reason::kBadCount}));
  EXPECT_EQ(bus.counts().num_bad(), 3);
}

TEST(Bus, ExceptionOfAHandlerLeavesThroughHandleAndTheBusGoesOn) {
  Bus bus("memq://");
  int num_handled = 0;
  bus.subscribe(Channel::kScan, [&](const Message&, Bytes) {
    if (++num_handled == 1) throw std::runtime_error("mine");
  });
  bus.publish(testing::fake_drive(1)[0]);
  EXPECT_THROW(bus.handle(0), std::runtime_error);
  bus.publish(testing::fake_drive(1)[0]);
  EXPECT_TRUE(bus.handle(0));
  EXPECT_EQ(num_handled, 2);
}

TEST(Bus, HandlersMayPublish) {
  Bus bus("memq://");
  int num_poses = 0;
  bus.subscribe(Channel::kScan, [&](const Message& m, Bytes) {
    pose::PoseEstimate pose;
    pose.utime = utime_of(m);
    bus.publish(pose);
  });
  bus.subscribe(Channel::kPose, [&](const Message&, Bytes) { ++num_poses; });
  bus.publish(testing::fake_drive(1)[0]);
  while (bus.handle(0)) {
  }
  EXPECT_EQ(num_poses, 1);
}

TEST(Bus, UnusableUrlIsOneClearSentence) {
  try {
    Bus bus("file:///tmp/some.lcm");
    FAIL();
  } catch (const BusError& error) {
    EXPECT_NE(std::string(error.what()).find("udpm://"), std::string::npos);
  }
  EXPECT_THROW(Bus("nonsense"), BusError);
  EXPECT_THROW(Bus("udpm://nonsense:port"), BusError);
}

}  // namespace
}  // namespace orchard::bus
