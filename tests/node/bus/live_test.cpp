// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <future>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/driver/live_driver.hpp"
#include "bus/node/live_node.hpp"
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

/// Ends after some steps, one a millisecond.
class Ending : public Driver {
 public:
  explicit Ending(int num_steps) : num_left_(num_steps) {}
  std::vector<pollfd> files() override { return {}; }
  Clock::time_point deadline() override { return Clock::now() + std::chrono::milliseconds(1); }
  void step(const Outbox&) override { --num_left_; }
  bool ended() const override { return num_left_ <= 0; }

 private:
  int num_left_;
};

/// The last STATUS of a driver that hears another process's.
Status status_beside(const std::string& name, std::int64_t ahead_us) {
  StopSignal stop;
  Bus bus("memq://");
  Ending driver(20);
  ProcessOptions options;
  LiveDriver live(bus, driver, "orchard-toy-driver", options);
  Status last;
  bus.subscribe_status([&](const Status& heard) {
    if (heard.host != "elsewhere:7") last = heard;
  });
  for (int k = 0; k < 4; ++k) {
    Status other;
    other.utime = wall_utime() + ahead_us;
    other.seq = k;
    other.name = name;
    other.host = "elsewhere:7";
    bus.publish(Channel::kStatus, encode(other));
  }
  live.run(stop);
  while (bus.handle(0)) {
  }
  return last;
}

TEST(LiveDriver, NamesASecondOneAndAnotherClock) {
  const Status duplicate = status_beside("orchard-toy-driver", 0);
  EXPECT_EQ(duplicate.level, Level::kError);
  EXPECT_NE(duplicate.text.find("orchard-toy-driver on elsewhere:7 runs beside"), std::string::npos)
      << duplicate.text;
  const Status skewed = status_beside("orchard-pose", 200'000'000);
  EXPECT_EQ(skewed.level, Level::kWarning);
  EXPECT_NE(skewed.text.find("the clock of elsewhere is"), std::string::npos) << skewed.text;
  const Status alone = status_beside("orchard-pose", 0);
  EXPECT_EQ(alone.level, Level::kOk);
  EXPECT_EQ(alone.text, "the source has ended");
}

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
                [&](Node&, const SaveRequest& request) {
                  return [&saves, request] { saves.push_back(request); };
                });
  for (const Message& message : testing::fake_drive(num_tenths)) bus.publish(message);
  bus.publish(Channel::kScan, {1, 2, 3});
  raise(SIGTERM);
  live.run(stop);
  return saves;
}

TEST(LiveNode, ANodeThatIsBehindForAMomentGetsAll) {
  Recorder node;
  const std::vector<SaveRequest> saves = run_behind(node, 12);
  ASSERT_EQ(node.scans.size(), 12u);
  EXPECT_EQ(node.scans.back(), 11);
  EXPECT_EQ(node.images, node.scans);
  EXPECT_EQ(node.num_flushes, 1);
}

TEST(LiveNode, TheLastSaveIsFinalAndKnowsWhatCame) {
  Recorder node;
  const std::vector<SaveRequest> saves = run_behind(node, 12);
  ASSERT_EQ(saves.size(), 1u);
  EXPECT_EQ(saves[0].kind, SaveKind::kFinal);
  const TrafficCounts& traffic = saves[0].traffic;
  EXPECT_EQ(traffic.num_in[static_cast<std::size_t>(Channel::kScan)], 12);
  EXPECT_EQ(traffic.num_in[static_cast<std::size_t>(Channel::kImage)], 12);
  EXPECT_EQ(traffic.num_rejected[static_cast<std::size_t>(Reason::kTooShort)], 1);
  EXPECT_EQ(traffic.num_seq_gaps, 0);
}

/// Tells when it has its twelfth scan.
class Awaited : public Recorder {
 public:
  void handle(const Message& input, const Outbox& send) override {
    Recorder::handle(input, send);
    if (scans.size() == 12 && !is_told_) twelve.set_value();
    is_told_ = scans.size() == 12;
  }
  std::promise<void> twelve;

 private:
  bool is_told_ = false;
};

TEST(LiveNode, HandlesMessagesWhileASaveIsWritten) {
  Awaited node;
  StopSignal stop;
  Bus bus("memq://");
  const std::shared_future<void> twelve = node.twelve.get_future().share();
  const std::vector<Message> drive = testing::fake_drive(12);
  bool was_beside = false;
  const auto save = [&](Node&, const SaveRequest& request) -> Writing {
    if (request.kind == SaveKind::kFinal) return {};
    for (std::size_t i = 1; i < drive.size(); ++i) bus.publish(drive[i]);
    return [&] {  // in vain where the node waits for its saves
      was_beside = twelve.wait_for(std::chrono::seconds(30)) == std::future_status::ready;
      ::kill(::getpid(), SIGTERM);
    };
  };
  LiveNode live(bus, node, "orchard-recorder", io::EffectiveConfig{}, save);
  bus.publish(drive.front());
  live.run(stop);
  EXPECT_TRUE(was_beside);
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
