// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <mutex>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/replay/in_process_replay.hpp"
#include "bus/replay/ordered_pipeline.hpp"
#include "bus/replay/replay_index.hpp"
#include "io/file_error.hpp"
#include "node/bus/fake_log.hpp"
#include "node/bus/fake_nodes.hpp"

namespace orchard::bus {
namespace {

using testing::fake_drive;
using testing::FakeDetector;
using testing::FakeMapper;
using testing::FakePose;
using testing::write_log;

struct Derived {
  Channel channel;
  std::int64_t utime;
  std::vector<std::uint8_t> bytes;
  bool operator==(const Derived& o) const {
    return channel == o.channel && utime == o.utime && bytes == o.bytes;
  }
};

class InProcessReplay : public ::testing::Test {
 protected:
  InProcessReplay() {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("orchard_replay_" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::create_directories(folder_);
  }
  ~InProcessReplay() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  ReplayReport replay(const std::string& log, std::vector<Derived>& derived, bool strict = false,
                      double from_s = 0, double to_s = 1e18, int num_jobs = 1) {
    FakeDetector detector;
    FakePose pose;
    FakeMapper mapper;
    ReplayOptions options;
    options.strict = strict;
    options.from_s = from_s;
    options.to_s = to_s;
    options.num_jobs = num_jobs;
    options.on_derived = [&](Channel channel, std::int64_t utime,
                             const std::vector<std::uint8_t>& bytes) {
      derived.push_back({channel, utime, bytes});
    };
    return replay_in_process(log, {&detector, &pose, &mapper}, options);
  }

  std::filesystem::path folder_;
};

TEST_F(InProcessReplay, HandsOverEveryMessageAndFlushes) {
  write_log(path("log"), fake_drive(50));
  std::vector<Derived> derived;
  const ReplayReport report = replay(path("log"), derived);
  EXPECT_EQ(report.num_in[static_cast<int>(Channel::kScan)], 50);
  EXPECT_EQ(report.num_in[static_cast<int>(Channel::kImage)], 50);
  EXPECT_EQ(report.num_in[static_cast<int>(Channel::kOdometry)], 250);
  EXPECT_EQ(report.num_out[static_cast<int>(Channel::kDetections)], 50);
  EXPECT_EQ(report.num_out[static_cast<int>(Channel::kPose)], 250);
  EXPECT_EQ(report.num_out[static_cast<int>(Channel::kMap)], 50);
  EXPECT_EQ(derived.size(), 350u);
  EXPECT_TRUE(report.warnings.empty());
}

TEST_F(InProcessReplay, OrderOfTheFileBetweenChannelsDoesNotMatter) {
  std::vector<Message> messages = fake_drive(60);
  write_log(path("a"), messages);
  std::vector<Derived> expected;
  replay(path("a"), expected);
  // As on a network: each channel keeps its order, between channels anything may happen.
  std::mt19937 random(5);
  for (int pass = 0; pass < 2000; ++pass) {
    const std::size_t i = random() % (messages.size() - 1);
    if (channel_of(messages[i]) != channel_of(messages[i + 1])) {
      std::swap(messages[i], messages[i + 1]);
    }
  }
  write_log(path("b"), messages);
  std::vector<Derived> shuffled;
  replay(path("b"), shuffled);
  EXPECT_TRUE(expected == shuffled);
}

TEST_F(InProcessReplay, TheNumberOfJobsDoesNotMatter) {
  write_log(path("log"), fake_drive(300));
  std::vector<Derived> expected;
  const ReplayReport report = replay(path("log"), expected);
  for (const int num_jobs : {0, 2, 3, 7}) {
    std::vector<Derived> derived;
    const ReplayReport other = replay(path("log"), derived, false, 0, 1e18, num_jobs);
    EXPECT_TRUE(derived == expected) << num_jobs;
    EXPECT_EQ(other.num_in, report.num_in) << num_jobs;
    EXPECT_EQ(other.num_out, report.num_out) << num_jobs;
  }
}

TEST_F(InProcessReplay, WhatACallbackThrowsEndsIt) {
  write_log(path("log"), fake_drive(300));
  for (const int num_jobs : {1, 2, 4}) {
    FakeDetector detector;
    FakePose pose;
    FakeMapper mapper;
    ReplayOptions options;
    options.num_jobs = num_jobs;
    std::uint64_t num_progress = 0;
    options.progress = [&](std::uint64_t done, std::uint64_t) {
      num_progress = done;
      if (done == 100) throw std::runtime_error("interrupted");
    };
    EXPECT_THROW(replay_in_process(path("log"), {&detector, &pose, &mapper}, options),
                 std::runtime_error);
    EXPECT_EQ(num_progress, 100u) << num_jobs;
  }
}

TEST_F(InProcessReplay, RecordedDerivedMessagesAreNotReplayed) {
  std::vector<Message> messages = fake_drive(10);
  write_log(path("a"), messages);
  pose::PoseEstimate wrong;
  wrong.utime = testing::kLogStart;
  wrong.x_m = 1000.0;
  messages.insert(messages.begin(), wrong);
  write_log(path("b"), messages);
  std::vector<Derived> a;
  std::vector<Derived> b;
  replay(path("a"), a);
  replay(path("b"), b);
  EXPECT_TRUE(a == b);
}

TEST_F(InProcessReplay, DuplicatesAndGapsAreCounted) {
  std::vector<Message> messages = fake_drive(10);
  messages.insert(messages.begin() + 8, messages[7]);
  messages.erase(messages.begin() + 22, messages.begin() + 24);  // a scan and its picture
  write_log(path("log"), messages);
  std::vector<Derived> derived;
  const ReplayReport report = replay(path("log"), derived);
  EXPECT_EQ(report.num_duplicates, 1);
  EXPECT_EQ(report.num_seq_gaps, 2);
  EXPECT_FALSE(report.warnings.empty());
}

TEST_F(InProcessReplay, BadMessagesAreCountedOrRefused) {
  std::vector<Message> messages = fake_drive(10);
  std::get<laser::Scan>(messages[7]).bearing_step_rad = 0.0;
  write_log(path("log"), messages);
  std::vector<Derived> derived;
  const ReplayReport report = replay(path("log"), derived);
  EXPECT_EQ(report.num_rejected[static_cast<int>(Reason::kOutOfRange)], 1);
  EXPECT_EQ(report.num_in[static_cast<int>(Channel::kScan)], 9);
  EXPECT_THROW(replay(path("log"), derived, true), io::FileError);
}

TEST_F(InProcessReplay, DamagedLogIsReplayedWithAWarningOrRefused) {
  write_log(path("log"), fake_drive(20));
  std::filesystem::resize_file(path("log"), std::filesystem::file_size(path("log")) - 10);
  std::vector<Derived> derived;
  const ReplayReport report = replay(path("log"), derived);
  EXPECT_EQ(report.gaps.size(), 1u);
  EXPECT_FALSE(report.warnings.empty());
  EXPECT_THROW(replay(path("log"), derived, true), io::FileError);
}

TEST_F(InProcessReplay, AClockThatDiffersFromTheOthersIsNamed) {
  const auto warnings_of = [&](std::int64_t scan_ahead_us, std::int64_t latency_us) {
    const std::string log = path("skewed.lcm");
    io::LogWriter writer(log);
    for (Message message : fake_drive(100)) {
      const std::int64_t measured = utime_of(message);
      const bool is_wheels = channel_of(message) == Channel::kOdometry;
      if (auto* scan = std::get_if<laser::Scan>(&message)) scan->utime += scan_ahead_us;
      if (auto* image = std::get_if<vision::Image>(&message)) image->utime += scan_ahead_us;
      writer.write(measured + (is_wheels ? 1000 : latency_us), info(channel_of(message)).name,
                   encode(message));
    }
    writer.close();
    std::string all;
    for (const std::string& warning : index_log(log, {}).report.warnings) all += warning;
    return all;
  };
  EXPECT_EQ(warnings_of(0, 0), "");
  EXPECT_EQ(warnings_of(0, 120'000), "") << "what a sweep and a picture take";
  EXPECT_NE(warnings_of(200'000, 0).find("the clock of the sender of SCAN, IMAGE is 0.20 s ahead"),
            std::string::npos);
  EXPECT_NE(warnings_of(-500'000, 0).find("the clock of its sender is behind"), std::string::npos);
  EXPECT_NE(warnings_of(200'000, 80'000).find("ahead of that of ODOMETRY"), std::string::npos);
}

TEST_F(InProcessReplay, ASecondSensorThatIsNotUsedIsNamed) {
  const std::string log = path("second.lcm");
  io::LogWriter writer(log);
  for (const Message& message : fake_drive(10)) {
    writer.write(utime_of(message), info(channel_of(message)).name, encode(message));
    writer.write(utime_of(message), "IMAGE.left", encode(message));
    writer.write(utime_of(message), "CAMERA.left", encode(message));
  }
  writer.close();
  const ReplayReport report = index_log(log, {}).report;
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_EQ(report.warnings[0].rfind("IMAGE.left: not used", 0), 0u) << report.warnings[0];
}

TEST_F(InProcessReplay, SecondsAreCutOut) {
  write_log(path("log"), fake_drive(50));
  std::vector<Derived> derived;
  const ReplayReport report = replay(path("log"), derived, false, 1.0, 2.05);
  EXPECT_EQ(report.num_in[static_cast<int>(Channel::kScan)], 11);
  EXPECT_EQ(report.first_utime, testing::kLogStart + 1000000);
}

TEST_F(InProcessReplay, LogsWithNothingToReplayAreRefused) {
  std::vector<Derived> derived;
  EXPECT_THROW(replay(path("absent"), derived), io::FileError);
  std::ofstream(path("empty")).close();
  EXPECT_THROW(replay(path("empty"), derived), io::FileError);
  std::ofstream(path("text")) << std::string(5000, 'x');
  EXPECT_THROW(replay(path("text"), derived), io::FileError);
  {
    io::LogWriter writer(path("other"));
    writer.write(1, "POSITION", {1, 2, 3});
    writer.close();
  }
  try {
    replay(path("other"), derived);
    FAIL();
  } catch (const io::FileError& error) {
    EXPECT_NE(std::string(error.what()).find("POSITION"), std::string::npos);
  }
}

/// Sends what the guard refuses.
class BrokenNode : public FakePose {
 public:
  void handle(const Message& input, const Outbox& send) override {
    pose::PoseEstimate estimate;
    estimate.utime = utime_of(input);
    estimate.yaw_rad = 40.0;
    send(estimate);
  }
};

TEST_F(InProcessReplay, NodeThatSendsNonsenseIsAnError) {
  write_log(path("log"), fake_drive(2));
  BrokenNode pose;
  FakeMapper mapper;
  EXPECT_THROW(replay_in_process(path("log"), {&pose, &mapper}, {}), std::logic_error);
}

TEST_F(InProcessReplay, NodesOutOfOrderAreAnError) {
  write_log(path("log"), fake_drive(2));
  FakePose pose;
  FakeMapper mapper;
  EXPECT_THROW(replay_in_process(path("log"), {&mapper, &pose}, {}), std::logic_error);
}

/// Numbers from 0 on: squared by whoever has time, summed up in order.
struct Squares {
  explicit Squares(std::size_t num_slots) : slots(num_slots) {}

  void run(int num_threads, int num_batches) {
    int next = 0;
    run_pipeline(
        [&](std::size_t slot) {
          if (next == num_batches) return false;
          slots[slot] = next++;
          return true;
        },
        {{false,
          [&](std::size_t slot) {
            before(slots[slot]);
            slots[slot] *= slots[slot];
          }},
         {true,
          [&](std::size_t slot) {
            sum += slots[slot];
            slots[slot] = sum;
          }},
         {true, [&](std::size_t slot) { seen.push_back(slots[slot]); }}},
        num_threads, slots.size());
  }

  std::vector<int> slots;
  std::function<void(int)> before = [](int) {};
  int sum = 0;
  std::vector<int> seen;
};

std::vector<int> sums_of_squares(int num) {
  std::vector<int> sums;
  for (int i = 0, sum = 0; i < num; ++i) sums.push_back(sum += i * i);
  return sums;
}

TEST(OrderedPipeline, GivesTheSameForAnyNumberOfThreads) {
  for (const int num_threads : {1, 2, 3, 8}) {
    Squares squares(5);
    squares.before = [](int batch) {  // some take much longer than those after them
      std::atomic<int> spent{0};
      while (spent < (batch % 5 == 0 ? 100'000 : 0)) ++spent;
    };
    squares.run(num_threads, 500);
    EXPECT_EQ(squares.seen, sums_of_squares(500)) << num_threads;
  }
}

TEST(OrderedPipeline, NothingToDoIsDoneAtOnce) {
  Squares squares(3);
  squares.run(4, 0);
  EXPECT_TRUE(squares.seen.empty());
}

TEST(OrderedPipeline, StagesWithoutOrderRunAtOnce) {
  // The first batch waits until another is in the same stage: with one thread it would for ever.
  std::mutex mutex;
  std::condition_variable entered;
  int num_inside = 0;
  Squares squares(4);
  squares.before = [&](int batch) {
    std::unique_lock<std::mutex> lock(mutex);
    ++num_inside;
    entered.notify_all();
    if (batch == 0) entered.wait(lock, [&] { return num_inside >= 2; });
  };
  squares.run(2, 10);
  EXPECT_EQ(squares.seen, sums_of_squares(10));
}

TEST(OrderedPipeline, NoMoreBatchesThanSlotsAreOnTheirWay) {
  std::atomic<int> on_their_way{0};
  std::atomic<int> most{0};
  int next = 0;
  run_pipeline(
      [&](std::size_t) {
        if (next++ == 200) return false;
        const int now = ++on_their_way;
        if (now > most) most = now;
        return true;
      },
      {{false, [](std::size_t) {}}, {true, [&](std::size_t) { --on_their_way; }}}, 4, 3);
  EXPECT_LE(most, 3);
  EXPECT_EQ(on_their_way, 0);
}

TEST(OrderedPipeline, TheEarliestErrorIsThrownAfterAllBeforeIt) {
  for (const int num_threads : {1, 2, 4}) {
    Squares squares(6);
    squares.before = [](int batch) {
      if (batch >= 20) throw std::runtime_error(std::to_string(batch));
    };
    try {
      squares.run(num_threads, 100);
      FAIL() << num_threads;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()), "20") << num_threads;
    }
    EXPECT_EQ(squares.seen, sums_of_squares(20)) << num_threads;
  }
}

TEST(OrderedPipeline, AnErrorOfWhatFillsIsThrownInItsTurn) {
  for (const int num_threads : {1, 3}) {
    int next = 0;
    int num_through = 0;
    const auto run = [&] {
      run_pipeline(
          [&](std::size_t) {
            if (next++ == 7) throw std::runtime_error("no more can be read");
            return true;
          },
          {{true, [&](std::size_t) { ++num_through; }}}, num_threads, 3);
    };
    EXPECT_THROW(run(), std::runtime_error);
    EXPECT_EQ(num_through, 7);
  }
}

void expect_the_same(const ReplayEntries& entries, const std::vector<ReplayEntry>& told) {
  ASSERT_EQ(entries.size(), told.size());
  std::size_t i = 0;
  for (const ReplayEntry& entry : entries) {
    ASSERT_LT(i, told.size());
    EXPECT_EQ(entry.drive_time, told[i].drive_time);
    EXPECT_EQ(entry.channel, told[i].channel);
    EXPECT_EQ(entry.seq, told[i].seq);
    EXPECT_EQ(entry.offset, told[i].offset);
    ++i;
  }
  EXPECT_EQ(i, told.size());
}

TEST(ReplayEntries, ReadAsTheyWereTold) {
  std::mt19937_64 random(1);
  ReplayEntries entries;
  std::vector<ReplayEntry> told;
  EXPECT_TRUE(entries.empty());
  expect_the_same(entries, told);
  const auto tell = [&](const ReplayEntry& entry) {
    entries.push_back(entry);
    told.push_back(entry);
  };
  for (int i = 0; i < 2000; ++i) {  // any value beside any other
    tell({static_cast<std::int64_t>(random()), static_cast<Channel>(random() % kNumChannels),
          static_cast<std::int32_t>(random()), random()});
  }
  for (const std::int64_t utime : {std::numeric_limits<std::int64_t>::min(), std::int64_t{0},
                                   std::numeric_limits<std::int64_t>::max()}) {
    tell({utime, Channel::kScan, std::numeric_limits<std::int32_t>::min(),
          std::numeric_limits<std::uint64_t>::max()});
    tell({utime, Channel::kScan, std::numeric_limits<std::int32_t>::max(), 0});
  }
  expect_the_same(entries, told);
  entries.shrink_to_fit();
  expect_the_same(entries, told);
}

}  // namespace

}  // namespace orchard::bus
