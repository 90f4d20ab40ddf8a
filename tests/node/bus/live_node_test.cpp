// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/live_node.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <functional>

#include "node/bus/fake_log.hpp"

namespace orchard::bus {
namespace {

/// Remembers what it was given.
class Recorder : public Node {
 public:
  std::string_view name() const override { return "detector"; }
  std::vector<Channel> inputs() const override { return {Channel::kScan, Channel::kImage}; }
  void handle(const Message& input, const Outbox&) override {
    (channel_of(input) == Channel::kScan ? scans : images).push_back(seq_of(input));
  }
  void flush(const Outbox&) override { ++num_flushes; }

  std::vector<std::int32_t> scans;
  std::vector<std::int32_t> images;
  int num_flushes = 0;
};

/// Everything arrives before the node is free for the first of it; then a stop is asked for.
std::vector<SaveRequest> run_behind(Recorder& node, int num_tenths) {
  StopSignal stop;
  Bus bus("memq://");
  std::vector<SaveRequest> saves;
  LiveNode live(bus, node, "orchard-recorder", io::EffectiveConfig{},
                [&](Node&, const SaveRequest& request) { saves.push_back(request); });
  for (const Message& message : testing::fake_drive(num_tenths)) bus.publish(message);
  bus.publish(Channel::kScan, {1, 2, 3});
  raise(SIGTERM);
  live.run(stop);
  return saves;
}

TEST(LiveNode, ASlowNodeGetsEveryScanButOnlyTheNewestImages) {
  Recorder node;
  const std::vector<SaveRequest> saves = run_behind(node, 12);
  ASSERT_EQ(node.scans.size(), 12u);
  EXPECT_EQ(node.scans.back(), 11);
  EXPECT_EQ(node.images, (std::vector<std::int32_t>{8, 9, 10, 11}));
  EXPECT_EQ(node.num_flushes, 1);
}

TEST(LiveNode, FewImagesAllArrive) {
  Recorder node;
  run_behind(node, 4);
  EXPECT_EQ(node.images, (std::vector<std::int32_t>{0, 1, 2, 3}));
}

TEST(LiveNode, TheLastSaveIsFinalAndKnowsWhatWasLost) {
  Recorder node;
  const std::vector<SaveRequest> saves = run_behind(node, 12);
  ASSERT_EQ(saves.size(), 1u);
  EXPECT_EQ(saves[0].kind, SaveKind::kFinal);
  const TrafficCounts& traffic = saves[0].traffic;
  EXPECT_EQ(traffic.num_in[static_cast<std::size_t>(Channel::kScan)], 12);
  EXPECT_EQ(traffic.num_in[static_cast<std::size_t>(Channel::kImage)], 4);
  EXPECT_EQ(traffic.num_rejected[static_cast<std::size_t>(Reason::kTooShort)], 1);
  EXPECT_EQ(traffic.num_seq_gaps, 0) << "the first image to arrive is where its count begins";
}

/// Is busy with something else before it can take anything.
class SlowStarter : public Recorder {
 public:
  void start(const std::function<void()>& on_progress) override {
    for (int i = 0; i < 3; ++i) on_progress();
    EXPECT_TRUE(scans.empty());
    has_started = true;
  }
  void handle(const Message& input, const Outbox& send) override {
    EXPECT_TRUE(has_started);
    Recorder::handle(input, send);
  }

  bool has_started = false;
};

TEST(LiveNode, WhatArrivesWhileItStartsWaits) {
  SlowStarter node;
  run_behind(node, 12);
  EXPECT_EQ(node.scans.size(), 12u);
}

/// Finds what it is given too late, and ends when STATUS says so or has not for long enough.
class Latecomer : public Recorder {
 public:
  NodeCounts counts() const override {
    NodeCounts counts;
    counts.num_late = num_late;
    return counts;
  }
  void handle_status(const Status& status) override {
    num_late += 3;
    ++num_heard;
    said = status.text;
    level = status.level;
    if (said.find("too late") != std::string::npos || num_heard > 20) raise(SIGTERM);
  }

  std::int64_t num_late = 0;
  int num_heard = 0;
  std::string said;
  Level level = Level::kOk;
};

TEST(LiveNode, SaysThatMessagesCameTooLateToBeUsed) {
  Latecomer node;
  StopSignal stop;
  Bus bus("memq://");
  LiveNode live(bus, node, "orchard-recorder", io::EffectiveConfig{}, {});
  live.run(stop);
  EXPECT_NE(node.said.find("arrived too late to be used"), std::string::npos) << node.said;
  EXPECT_GE(node.level, Level::kWarning);
}

}  // namespace
}  // namespace orchard::bus
