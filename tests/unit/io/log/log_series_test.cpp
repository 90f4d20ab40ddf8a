// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "io/file_error.hpp"
#include "io/log/log_writer.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Event = std::tuple<std::int64_t, std::string, std::vector<std::uint8_t>>;
using Events = std::vector<Event>;

Events of_drive(int num) {
  Events events;
  for (int k = 0; k < num; ++k) {
    // every fifth is received in the same microsecond as the one before
    events.emplace_back(1000000 + 20000 * (k - (k % 5 == 4 ? 1 : 0)), k % 3 == 0 ? "SCAN" : "POSE",
                        std::vector<std::uint8_t>{static_cast<std::uint8_t>(k),
                                                  static_cast<std::uint8_t>(k / 256), 7});
  }
  return events;
}

void write_log(const std::string& path, const Events& drive, int begin, int end) {
  LogWriter writer(path);
  for (int k = begin; k < end; ++k) {
    const auto& [time, channel, data] = drive[static_cast<std::size_t>(k)];
    writer.write(time, channel, data);
  }
  writer.close();
}

Events read_all(LogSeries& series) {
  Events events;
  while (const auto event = series.next()) {
    events.emplace_back(event->timestamp_us, event->channel, event->data);
  }
  return events;
}

class LogSeriesTest : public ::testing::Test {
 protected:
  std::string piece(int begin, int end) {
    const std::string path = folder / ("drive." + std::to_string(paths.size()));
    write_log(path, drive, begin, end);
    paths.push_back(path);
    return path;
  }
  TestFolder folder;
  const Events drive = of_drive(300);
  std::vector<std::string> paths;
};

TEST_F(LogSeriesTest, PiecesInAnyOrderAreTheWhole) {
  piece(0, 101);
  piece(101, 102);
  piece(102, 300);
  std::sort(paths.begin(), paths.end());
  do {
    LogSeries series(paths);
    EXPECT_EQ(read_all(series), drive);
    EXPECT_EQ(series.num_events(), 300);
    EXPECT_THAT(series.notes(), IsEmpty());
    EXPECT_THAT(series.gaps(), IsEmpty());
    EXPECT_EQ(series.position(), series.file_size());
  } while (std::next_permutation(paths.begin(), paths.end()));
}

TEST_F(LogSeriesTest, WhatTwoLogsHoldIsGivenOnce) {
  piece(0, 180);
  piece(120, 300);
  LogSeries series(paths);
  EXPECT_EQ(read_all(series), drive);
  EXPECT_THAT(series.notes(),
              ElementsAre("60 messages of drive.1 are also in another log; they are used once"));
}

TEST_F(LogSeriesTest, TheSameLogTwiceIsTheLog) {
  piece(0, 300);
  LogSeries series(std::vector<std::string>{paths[0], paths[0]});
  EXPECT_EQ(read_all(series), drive);
}

TEST_F(LogSeriesTest, WhatASenderRepeatsIsNotTheSeriesToJudge) {
  Events repeating = drive;
  repeating.insert(repeating.begin() + 50, repeating[49]);
  write_log(folder / "a", repeating, 0, 200);
  write_log(folder / "b", repeating, 200, 301);
  LogSeries series(std::vector<std::string>{folder / "a", folder / "b"});
  EXPECT_EQ(read_all(series), repeating);
}

TEST_F(LogSeriesTest, ASilenceBetweenLogsAndAnEmptyOneAreSaid) {
  piece(0, 100);
  piece(200, 300);
  write_bytes(folder / "empty", "");
  paths.push_back(folder / "empty");
  LogSeries series(paths);
  EXPECT_EQ(read_all(series).size(), 200u);
  // from event 99, received with 98, to event 200: 102 periods of 20 ms
  EXPECT_THAT(series.notes(), ElementsAre("nothing was recorded for 2.0 s before drive.1",
                                          HasSubstr("empty has no LCM event")));
}

TEST_F(LogSeriesTest, EachEventIsFoundAgain) {
  for (int k = 0; k < 20; ++k) piece(15 * k, 15 * (k + 1));
  std::vector<std::uint64_t> offsets;
  LogSeries series(paths);
  while (const auto event = series.next()) offsets.push_back(event->offset);
  ASSERT_EQ(offsets.size(), drive.size());
  for (const std::size_t step : {std::size_t{7}, std::size_t{131}}) {
    for (std::size_t i = 0, k = 0; i < drive.size(); ++i, k = (k + step) % drive.size()) {
      EXPECT_EQ(series.read_at(offsets[k]).data, std::get<2>(drive[k]));
    }
  }
  EXPECT_THAT(series.where(offsets[45]), HasSubstr("drive.3 at offset 0"));
}

TEST_F(LogSeriesTest, APieceThatIsTornIsReadUpToThere) {
  piece(0, 150);
  piece(150, 300);
  const std::string bytes = read_bytes(paths[0]);
  write_bytes(paths[0], bytes.substr(0, bytes.size() - 3));
  LogSeries series(paths);
  EXPECT_EQ(read_all(series).size(), 299u);
  EXPECT_EQ(series.gaps().size(), 1u);
}

TEST(LogSeries, ALogThatIsNotThereIsNamed) {
  const TestFolder folder;
  EXPECT_THROW(LogSeries(folder / "none.lcm"), FileError);
  EXPECT_THROW(LogSeries(std::vector<std::string>{}), FileError);
}

/// A log of real messages (tests/data), cut at every byte: an event at most is lost, and said.
TEST(RecordedLog, CutAtEveryByteLosesOneEventAndSaysSo) {
  const TestFolder folder;
  const std::string bytes = read_bytes(ORCHARD_SOURCE_DIR "/tests/data/golden.lcm");
  std::vector<std::uint64_t> ends;
  LogReader whole(ORCHARD_SOURCE_DIR "/tests/data/golden.lcm");
  while (whole.next()) ends.push_back(whole.position());
  ASSERT_GT(ends.size(), 5u);
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    write_bytes(folder / "cut.lcm", bytes.substr(0, size));
    LogSeries series(folder / "cut.lcm");
    while (series.next()) {
    }
    const auto num_whole =
        std::count_if(ends.begin(), ends.end(), [size](std::uint64_t end) { return end <= size; });
    ASSERT_EQ(series.num_events(), num_whole) << size;
    const bool at_an_end = std::count(ends.begin(), ends.end(), size) > 0;
    ASSERT_EQ(series.gaps().size(), at_an_end ? 0u : 1u) << size;
  }
}

TEST(RecordedLog, AFlippedByteCostsTwoEventsAtMostAndLostBytesAreSaid) {
  const TestFolder folder;
  const std::string bytes = read_bytes(ORCHARD_SOURCE_DIR "/tests/data/golden.lcm");
  Events good;
  LogSeries whole(ORCHARD_SOURCE_DIR "/tests/data/golden.lcm");
  good = read_all(whole);
  for (const int mask : {0x01, 0x10, 0x80, 0xFF}) {
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::string flipped = bytes;
      flipped[at] = static_cast<char>(flipped[at] ^ mask);
      write_bytes(folder / "flipped.lcm", flipped);
      LogSeries series(folder / "flipped.lcm");
      const Events events = read_all(series);
      const auto num_kept = std::count_if(good.begin(), good.end(), [&](const Event& event) {
        return std::count(events.begin(), events.end(), event) > 0;
      });
      ASSERT_GE(num_kept + 2, static_cast<std::ptrdiff_t>(good.size())) << at;
      if (events.size() < good.size()) {
        ASSERT_FALSE(series.gaps().empty()) << at;
      }
    }
  }
}

}  // namespace
}  // namespace orchard::io
