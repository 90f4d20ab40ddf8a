// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/sequence_gate.hpp"

#include <gtest/gtest.h>

namespace orchard::bus {
namespace {

TEST(SequenceGate, CountsWhatIsMissing) {
  SequenceGate gate;
  EXPECT_TRUE(gate.accept(Channel::kScan, 10, 100));  // a late joiner has lost nothing
  EXPECT_TRUE(gate.accept(Channel::kScan, 11, 200));
  EXPECT_TRUE(gate.accept(Channel::kScan, 15, 300));
  EXPECT_EQ(gate.counts().num_lost, 3);
}

TEST(SequenceGate, RefusesTheSameAndOlder) {
  SequenceGate gate;
  EXPECT_TRUE(gate.accept(Channel::kScan, 10, 100));
  EXPECT_FALSE(gate.accept(Channel::kScan, 10, 100));
  EXPECT_FALSE(gate.accept(Channel::kScan, 9, 90));
  EXPECT_EQ(gate.counts().num_duplicate, 2);
  EXPECT_TRUE(gate.accept(Channel::kImage, 9, 90));  // each channel on its own
}

TEST(SequenceGate, AcceptsARestartedSource) {
  SequenceGate gate;
  EXPECT_TRUE(gate.accept(Channel::kScan, 500, 100));
  EXPECT_TRUE(gate.accept(Channel::kScan, 0, 5000));
  EXPECT_TRUE(gate.accept(Channel::kScan, 1, 5100));
  EXPECT_EQ(gate.counts().num_restarts, 1);
  EXPECT_EQ(gate.counts().num_lost, 0);
}

TEST(SequenceGate, SeveralMessagesMayHaveOneTime) {
  SequenceGate gate;
  EXPECT_TRUE(gate.accept(Channel::kPose, 0, 100));
  EXPECT_TRUE(gate.accept(Channel::kPose, 1, 100));
}

TEST(SequenceGate, OneTimeFromTheFutureDoesNotShutTheChannel) {
  SequenceGate gate;
  EXPECT_TRUE(gate.accept(Channel::kScan, 0, 100));
  EXPECT_TRUE(gate.accept(Channel::kScan, 1, 7000000000000000));
  int num_refused = 0;
  for (int i = 2; i < 30; ++i) num_refused += gate.accept(Channel::kScan, i, 100 + i) ? 0 : 1;
  EXPECT_EQ(num_refused, 9);
  EXPECT_EQ(gate.counts().num_backward, 10);
}

}  // namespace
}  // namespace orchard::bus
