// SPDX-License-Identifier: BSD-3-Clause
// A simulated drive with one nasty message or one fault of a clock: the map is that of the clean
// drive, every tree and object of it, and nothing else.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "detector/detector_node.hpp"
#include "io/log/log_writer.hpp"
#include "mapper/mapper_node.hpp"
#include "pose/pose_node.hpp"
#include "sim_driver/sim_source.hpp"

namespace orchard::test {
namespace {

using bus::Channel;
using bus::Message;

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kFarFuture = 7'258'118'400 * kSecond - 1;  // the last time that passes

std::size_t index(Channel channel) { return static_cast<std::size_t>(channel); }

void stamp(Message& message, std::int64_t utime, std::int32_t seq) {
  std::visit(
      [&](auto& m) {
        m.utime = utime;
        m.seq = seq;
      },
      message);
}

struct Mapped {
  std::vector<mapping::Landmark> landmarks;
  bus::ReplayReport report;
};

class NastyLogs : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    config_ = std::make_unique<io::Config>(
        io::load_config(std::string(ORCHARD_SOURCE_DIR) + "/config/orchard.yaml"));
    procs::SimDriverOptions options;
    options.scene = "orchard";
    options.seed = "7";
    const auto source = procs::make_sim_source(options, *config_);
    // one row and the turn into the next: what a message spoils at 20 s, nobody sees again
    while (const auto message = source->next()) {
      if (!drive_.empty() && bus::utime_of(*message) - start() > 40 * kSecond) break;
      drive_.push_back(*message);
    }
    clean_ = std::make_unique<Mapped>(map(drive_));
    ASSERT_GT(clean_->landmarks.size(), 30u);
  }
  static void TearDownTestSuite() {
    config_.reset();
    clean_.reset();
    drive_.clear();
  }

  static std::int64_t start() { return bus::utime_of(drive_.front()); }

  static Mapped map(const std::vector<Message>& messages) {
    const std::string path = (std::filesystem::path(::testing::TempDir()) /
                              (std::to_string(::getpid()) + ".orchard_nasty.lcm"))
                                 .string();
    io::LogWriter writer(path);
    for (const Message& message : messages) {
      const Channel channel = bus::channel_of(message);
      writer.write(bus::utime_of(message), bus::info(channel).name, bus::encode(message));
    }
    writer.close();
    procs::DetectorNode detector(*config_);
    procs::PoseNode pose(*config_);
    procs::MapperNode mapper(*config_);
    Mapped mapped;
    mapped.report = bus::replay_in_process(path, {&detector, &pose, &mapper}, {});
    mapped.landmarks = mapper.landmarks();
    std::filesystem::remove(path);
    return mapped;
  }

  /// The drive with a copy of one message of a channel, 20 s from its start, stamped otherwise.
  static std::vector<Message> with_one(Channel channel, std::int64_t utime, std::int32_t seq) {
    std::vector<Message> messages = drive_;
    const auto at = std::find_if(messages.begin(), messages.end(), [&](const Message& message) {
      return bus::channel_of(message) == channel && bus::utime_of(message) - start() > 20 * kSecond;
    });
    Message copy = *at;
    stamp(copy, utime, seq < 0 ? bus::seq_of(copy) + 1 : seq);
    messages.insert(at, copy);
    return messages;
  }

  static void expect_clean_map(const Mapped& mapped) {
    const auto without = [](const std::vector<mapping::Landmark>& these,
                            const std::vector<mapping::Landmark>& those) {
      std::string text;
      for (const mapping::Landmark& a : these) {
        const bool is_there =
            std::any_of(those.begin(), those.end(), [&](const mapping::Landmark& b) {
              // A bush falls into one landmark or several by a hair.
              const double near_m = 0.2 + 0.5 * b.width_m;
              return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) <= near_m;
            });
        if (is_there || a.num_observations < 2) continue;  // seen once is not yet a thing
        text += fmt::format("{} at ({:.2f}, {:.2f}) seen {} times, {:.2f} m wide; ", a.id, a.x_m,
                            a.y_m, a.num_observations, a.width_m);
      }
      return text;
    };
    EXPECT_EQ(without(clean_->landmarks, mapped.landmarks), "") << "gone";
    EXPECT_EQ(without(mapped.landmarks, clean_->landmarks), "") << "new";
  }

  inline static std::unique_ptr<io::Config> config_;
  inline static std::vector<Message> drive_;
  inline static std::unique_ptr<Mapped> clean_;
};

TEST_F(NastyLogs, OneMessageOfTheFutureIsLeftOutAndSaid) {
  for (const Channel channel :
       {Channel::kScan, Channel::kImage, Channel::kOdometry, Channel::kPoseFix, Channel::kGnss}) {
    SCOPED_TRACE(bus::info(channel).name);
    for (const std::int64_t utime : {kFarFuture, start() + 86'400 * kSecond}) {
      const Mapped mapped = map(with_one(channel, utime, utime == kFarFuture ? INT32_MAX : -1));
      expect_clean_map(mapped);
      EXPECT_EQ(mapped.report.num_in[index(channel)], clean_->report.num_in[index(channel)]);
      ASSERT_EQ(mapped.report.warnings.size(), 1u);
      EXPECT_NE(mapped.report.warnings[0].find("1 " + std::string(bus::info(channel).name)),
                std::string::npos);
    }
  }
}

TEST_F(NastyLogs, AFirstMessageOfTheFutureIsLeftOut) {
  std::vector<Message> messages = drive_;
  Message scan = *std::find_if(messages.begin(), messages.end(), [](const Message& message) {
    return bus::channel_of(message) == Channel::kScan;
  });
  stamp(scan, kFarFuture, 1000);
  messages.insert(messages.begin(), scan);
  const Mapped mapped = map(messages);
  expect_clean_map(mapped);
  EXPECT_EQ(mapped.report.num_in[index(Channel::kScan)],
            clean_->report.num_in[index(Channel::kScan)]);
}

TEST_F(NastyLogs, DriversThatStartAgainWithAnEarlierClockGoOn) {
  // Set back by less than the drive is long, its halves have the same times.
  for (const std::int64_t back_us : {10 * kSecond, 60 * kSecond, 3600 * kSecond, 86400 * kSecond}) {
    std::vector<Message> messages = drive_;
    std::map<Channel, std::int32_t> first_seq;
    for (Message& message : messages) {
      if (bus::utime_of(message) - start() <= 20 * kSecond) continue;
      const std::int32_t first =
          first_seq.emplace(bus::channel_of(message), bus::seq_of(message)).first->second;
      stamp(message, bus::utime_of(message) - back_us, bus::seq_of(message) - first);
    }
    const Mapped mapped = map(messages);
    expect_clean_map(mapped);
    EXPECT_EQ(mapped.report.num_in, clean_->report.num_in) << "none is lost";
    EXPECT_EQ(mapped.report.num_out, clean_->report.num_out);
    EXPECT_FALSE(mapped.report.warnings.empty()) << "the change is said";
  }
}

TEST_F(NastyLogs, WhatIsSeenBeforeTheFirstFixIsPlacedByTheWheels) {
  std::vector<Message> messages = drive_;
  messages.erase(std::remove_if(messages.begin(), messages.end(),
                                [](const Message& message) {
                                  return bus::channel_of(message) == Channel::kPoseFix &&
                                         bus::utime_of(message) - start() < 11.75 * kSecond;
                                }),
                 messages.end());
  expect_clean_map(map(messages));
}

TEST_F(NastyLogs, WithoutAnyPoseNothingIsMapped) {
  std::vector<Message> messages = drive_;
  messages.erase(std::remove_if(messages.begin(), messages.end(),
                                [](const Message& message) {
                                  return bus::channel_of(message) == Channel::kPoseFix;
                                }),
                 messages.end());
  EXPECT_TRUE(map(messages).landmarks.empty());
}

TEST_F(NastyLogs, DuplicatedAndReorderedMessagesChangeNothing) {
  std::vector<Message> messages;
  for (std::size_t i = 0; i < drive_.size(); ++i) {
    messages.push_back(drive_[i]);
    if (i % 10 == 3) messages.push_back(drive_[i]);
  }
  for (std::size_t i = 0; i + 7 < messages.size(); i += 9) std::swap(messages[i], messages[i + 7]);
  const Mapped mapped = map(messages);
  EXPECT_EQ(mapped.report.num_in, clean_->report.num_in);
  EXPECT_EQ(mapped.report.num_seq_gaps, 0);
  EXPECT_EQ(mapped.report.num_out, clean_->report.num_out);
  expect_clean_map(mapped);
}

}  // namespace
}  // namespace orchard::test
