// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_recorder.hpp"
#include "io/log/log_series.hpp"
#include "io/log/log_writer.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kNumEvents = 8;

std::string channel_of(int i) { return i % 3 == 0 ? "SCAN" : "ODOMETRY"; }

std::vector<std::uint8_t> data_of(int i) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(5 + 9 * i));
  std::iota(data.begin(), data.end(), static_cast<std::uint8_t>(17 * i));
  return data;
}

std::string write_log(const std::string& path) {
  LogWriter writer(path);
  for (int i = 0; i < kNumEvents; ++i) writer.write(1000 + i, channel_of(i), data_of(i));
  writer.close();
  return read_bytes(path);
}

std::vector<LogEvent> read_all(LogReader& reader) {
  std::vector<LogEvent> events;
  while (auto event = reader.next()) events.push_back(std::move(*event));
  return events;
}

std::vector<LogEvent> read_text(const std::string& bytes, std::vector<LogGap>* gaps = nullptr) {
  LogReader reader(std::make_unique<std::istringstream>(bytes), "test");
  auto events = read_all(reader);
  if (gaps != nullptr) *gaps = reader.gaps();
  return events;
}

/// Whether event i of the log is among those read, byte for byte.
bool holds(const std::vector<LogEvent>& events, int i) {
  for (const LogEvent& event : events) {
    if (event.event_number == i && event.timestamp_us == 1000 + i &&
        event.channel == channel_of(i) && event.data == data_of(i)) {
      return true;
    }
  }
  return false;
}

TEST(Log, WhatIsWrittenIsRead) {
  const TestFolder folder;
  write_log(folder / "a.lcm");
  LogReader reader(folder / "a.lcm");
  const auto events = read_all(reader);
  ASSERT_THAT(events, SizeIs(kNumEvents));
  for (int i = 0; i < kNumEvents; ++i) EXPECT_TRUE(holds(events, i)) << i;
  EXPECT_TRUE(reader.gaps().empty());
  EXPECT_EQ(reader.position(), reader.file_size());
  for (int i = kNumEvents - 1; i >= 0; --i) {
    EXPECT_EQ(reader.read_at(events[static_cast<std::size_t>(i)].offset).data, data_of(i));
  }
  EXPECT_THROW(reader.read_at(3), FileError);
}

TEST(Log, LcmReadsOurs) {
  const TestFolder folder;
  write_log(folder / "a.lcm");
  lcm_eventlog_t* log = lcm_eventlog_create((folder / "a.lcm").c_str(), "r");
  ASSERT_NE(log, nullptr);
  for (int i = 0; i < kNumEvents; ++i) {
    lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log);
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->eventnum, i);
    EXPECT_EQ(event->timestamp, 1000 + i);
    EXPECT_EQ(std::string(event->channel, static_cast<std::size_t>(event->channellen)),
              channel_of(i));
    const auto* bytes = static_cast<const std::uint8_t*>(event->data);
    EXPECT_EQ(std::vector<std::uint8_t>(bytes, bytes + event->datalen), data_of(i));
    lcm_eventlog_free_event(event);
  }
  EXPECT_EQ(lcm_eventlog_read_next_event(log), nullptr);
  lcm_eventlog_destroy(log);
}

TEST(Log, WeReadLcms) {
  const TestFolder folder;
  lcm_eventlog_t* log = lcm_eventlog_create((folder / "a.lcm").c_str(), "w");
  ASSERT_NE(log, nullptr);
  for (int i = 0; i < kNumEvents; ++i) {
    std::string channel = channel_of(i);
    std::vector<std::uint8_t> data = data_of(i);
    lcm_eventlog_event_t event{};
    event.timestamp = 1000 + i;
    event.channel = channel.data();
    event.channellen = static_cast<int>(channel.size());
    event.data = data.data();
    event.datalen = static_cast<int>(data.size());
    ASSERT_EQ(lcm_eventlog_write_event(log, &event), 0);
  }
  lcm_eventlog_destroy(log);
  LogReader reader(folder / "a.lcm");
  const auto events = read_all(reader);
  ASSERT_THAT(events, SizeIs(kNumEvents));
  for (int i = 0; i < kNumEvents; ++i) EXPECT_TRUE(holds(events, i)) << i;
  EXPECT_TRUE(reader.gaps().empty());
}

TEST(Log, EveryUndamagedEventIsReadWhicheverByteIsDamaged) {
  const TestFolder folder;
  const std::string good = write_log(folder / "a.lcm");
  const auto whole = read_text(good);
  for (const int mask : {0x01, 0x08, 0x40, 0x80, 0xFF}) {
    for (std::size_t at = 0; at < good.size(); ++at) {
      std::string bad = good;
      bad[at] = static_cast<char>(bad[at] ^ mask);
      std::vector<LogGap> lost;
      const auto events = read_text(bad, &lost);
      ASSERT_TRUE(events.size() == std::size_t{kNumEvents} || !lost.empty()) << at;
      for (int i = 0; i < kNumEvents; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const std::uint64_t end = i + 1 < kNumEvents ? whole[k + 1].offset : good.size();
        const bool damaged = at >= whole[k].offset && at < end;
        ASSERT_TRUE(damaged || holds(events, i))
            << "byte " << at << " mask " << mask << " event " << i;
      }
      ASSERT_LE(events.size(), static_cast<std::size_t>(kNumEvents));
    }
  }
}

TEST(Log, ALengthThatEndsWhereALaterEventBeginsIsSeenThrough) {
  const TestFolder folder;
  LogWriter writer(folder / "a.lcm");
  for (int k = 0; k < 4; ++k) {  // 64 bytes each: 28 + 4 + 32
    writer.write(k, "SCAN", std::vector<std::uint8_t>(32, 7));
  }
  writer.close();
  std::string log = read_bytes(folder / "a.lcm");
  log[64 + 27] = 32 + 64;  // the second swallows the third exactly
  std::vector<LogGap> gaps;
  const auto events = read_text(log, &gaps);
  ASSERT_THAT(events, SizeIs(3));
  EXPECT_EQ(events[1].event_number, 2);
  ASSERT_THAT(gaps, SizeIs(1));
  EXPECT_EQ(gaps[0].offset, 64u);
  EXPECT_EQ(gaps[0].size, 64u);
}

TEST(Log, GarbageBetweenEventsAndHugeOrNegativeLengthsAreGaps) {
  const TestFolder folder;
  const std::string good = write_log(folder / "a.lcm");
  const auto whole = read_text(good);
  const std::string garbage = std::string("\xED\xA1\xDA\x01", 4) + std::string(40, '\xEE');
  std::vector<LogGap> gaps;
  const std::string with_garbage =
      good.substr(0, whole[3].offset) + garbage + good.substr(whole[3].offset);
  EXPECT_THAT(read_text(with_garbage, &gaps), SizeIs(kNumEvents));
  ASSERT_THAT(gaps, SizeIs(1));
  EXPECT_EQ(gaps[0].offset, whole[3].offset);
  EXPECT_EQ(gaps[0].size, garbage.size());
  for (const std::size_t field : {20u, 24u}) {  // channel and data length
    for (const std::string length : {"\x7F\xFF\xFF\xFF", "\xFF\xFF\xFF\xFF"}) {
      std::string bad = good;
      bad.replace(whole[2].offset + field, 4, length);
      EXPECT_THAT(read_text(bad, &gaps), SizeIs(kNumEvents - 1));
      ASSERT_THAT(gaps, SizeIs(1));
      EXPECT_EQ(gaps[0].offset, whole[2].offset);
      EXPECT_EQ(gaps[0].size, whole[3].offset - whole[2].offset);
    }
  }
}

TEST(Log, WhatIsNoLogIsNamed) {
  const TestFolder folder;
  EXPECT_THROW(LogReader(folder / "missing.lcm"), FileError);
  EXPECT_THROW(LogReader(folder.path()), FileError);
  write_bytes(folder / "text", std::string(100000, 'x'));
  LogReader reader(folder / "text");
  EXPECT_FALSE(reader.next().has_value());
  ASSERT_THAT(reader.gaps(), SizeIs(1));
  EXPECT_EQ(reader.gaps()[0].size, 100000u);
}

TEST(LogWriter, WithoutCloseTheOldLogStays) {
  const TestFolder folder;
  const std::string good = write_log(folder / "a.lcm");
  {
    LogWriter writer(folder / "a.lcm");
    writer.write(1, "SCAN", {1, 2, 3});
    EXPECT_THROW(LogWriter(folder / "a.lcm"), FileError) << "two writers at one log";
  }
  EXPECT_EQ(read_bytes(folder / "a.lcm"), good);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.lcm.part"));
}

TEST(LogWriter, RefusesWhatCannotBeReadBack) {
  const TestFolder folder;
  LogWriter writer(folder / "a.lcm");
  EXPECT_THROW(writer.write(1, "", {}), FileError);
  EXPECT_THROW(writer.write(1, "a b", {}), FileError);
  EXPECT_THROW(writer.write(1, std::string(64, 'a'), {}), FileError);
  EXPECT_THROW(LogWriter("/dev/full"), FileError);
  EXPECT_THROW(LogWriter(folder / "no/such/a.lcm"), FileError);
}

TEST(LogRepair, WhatCanBeReadIsCopiedAndNumberedAnew) {
  const TestFolder folder;
  const std::string good = write_log(folder / "a.lcm");
  const auto whole = read_text(good);
  std::string bad = good;
  bad[whole[4].offset] = 0;
  write_bytes(folder / "bad.lcm", bad);
  const LogRepair repair = repair_log(folder / "bad.lcm", folder / "good.lcm");
  EXPECT_EQ(repair.num_events, kNumEvents - 1);
  EXPECT_EQ(repair.num_lost_bytes, whole[5].offset - whole[4].offset);
  std::vector<LogGap> gaps;
  const auto events = read_text(read_bytes(folder / "good.lcm"), &gaps);
  EXPECT_TRUE(gaps.empty());
  ASSERT_THAT(events, SizeIs(kNumEvents - 1));
  for (std::size_t i = 0; i < events.size(); ++i) {
    const int k = static_cast<int>(i) + (i >= 4 ? 1 : 0);
    EXPECT_EQ(events[i].event_number, static_cast<std::int64_t>(i));
    EXPECT_EQ(events[i].timestamp_us, 1000 + k);
    EXPECT_EQ(events[i].channel, channel_of(k));
    EXPECT_EQ(events[i].data, data_of(k));
  }
  EXPECT_THROW(repair_log(folder / "a.lcm", folder / "a.lcm"), FileError);
  const std::string repaired = read_bytes(folder / "good.lcm");
  write_bytes(folder / "text", "no log");
  EXPECT_THROW(repair_log(folder / "text", folder / "good.lcm"), FileError);
  EXPECT_EQ(read_bytes(folder / "good.lcm"), repaired);
}

class LogRecorderTest : public testing::Test {
 protected:
  LogRecorderTest() { limits_.least_free_bytes = 0; }
  std::string stem() const { return folder_ / "made/drive"; }
  std::string file(int number) const {
    char name[32];
    std::snprintf(name, sizeof(name), "made/drive-%03d.lcm", number);
    return folder_ / name;
  }
  static std::vector<std::string> events_of(const std::string& path) {
    std::vector<std::string> texts;
    LogReader reader(path);
    while (const auto event = reader.next()) {
      texts.push_back(event->channel + " " + std::to_string(event->timestamp_us) + " " +
                      std::string(event->data.begin(), event->data.end()));
    }
    return texts;
  }
  static void put(LogRecorder& recorder, std::int64_t utime, const std::string& text) {
    recorder.write(utime, "SCAN", reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }
  TestFolder folder_;
  RecordingLimits limits_;
};

TEST_F(LogRecorderTest, WhatWasSyncedIsReadableUnderItsNameAtOnce) {
  LogRecorder recorder(stem(), limits_);
  put(recorder, 11, "one");
  put(recorder, 12, "two");
  recorder.sync();
  EXPECT_EQ(events_of(file(0)), (std::vector<std::string>{"SCAN 11 one", "SCAN 12 two"}));
  EXPECT_EQ(recorder.num_written(), 2);
  EXPECT_EQ(recorder.problem(), "");
}

TEST_F(LogRecorderTest, FilesAreSplitAndNoEventIsLostBetweenThem) {
  limits_.split_bytes = 1000;
  {
    LogRecorder recorder(stem(), limits_);
    for (int i = 0; i < 100; ++i) {
      put(recorder, i, std::string(400, 'x'));
      recorder.sync();
    }
  }
  int next = 0;
  for (int number = 0; fs::exists(file(number)); ++number) {
    for (const std::string& event : events_of(file(number))) {
      EXPECT_EQ(event.substr(0, event.rfind(' ')), "SCAN " + std::to_string(next++));
    }
    EXPECT_LT(fs::file_size(file(number)), 1000u + 2 * 450u);
  }
  EXPECT_EQ(next, 100);
}

TEST_F(LogRecorderTest, TheOldestFilesGoBeyondTheLimit) {
  limits_.split_bytes = 1000;
  limits_.keep_bytes = 5000;
  LogRecorder recorder(stem(), limits_);
  for (int i = 0; i < 100; ++i) {
    put(recorder, i, std::string(400, 'x'));
    recorder.sync();
  }
  std::uintmax_t total = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "made")) total += entry.file_size();
  EXPECT_LE(total, 5000u + 1500u);
  EXPECT_FALSE(fs::exists(file(0)));
}

TEST_F(LogRecorderTest, NothingIsWrittenWhenTheDiskIsNearlyFullAndItIsSaid) {
  limits_.least_free_bytes = std::int64_t{1} << 62;
  LogRecorder recorder(stem(), limits_);
  put(recorder, 1, "lost");
  recorder.sync();
  EXPECT_EQ(recorder.num_dropped(), 1);
  EXPECT_NE(recorder.problem().find("recording is paused"), std::string::npos);
  EXPECT_EQ(fs::file_size(file(0)), 0u);
}

TEST_F(LogRecorderTest, AnEarlierRecordingIsNeverOverwritten) {
  { LogRecorder recorder(stem(), limits_); }
  EXPECT_THROW(LogRecorder(stem(), limits_), FileError);
}

TEST_F(LogRecorderTest, WhatNoLogMayHoldIsLeftOutAndCounted) {
  LogRecorder recorder(stem(), limits_);
  recorder.write(1, "", nullptr, 0);
  recorder.write(1, "BAD NAME", nullptr, 0);
  recorder.write(1, std::string(64, 'C'), nullptr, 0);
  put(recorder, 2, "good");
  recorder.sync();
  EXPECT_EQ(recorder.num_dropped(), 3);
  EXPECT_EQ(events_of(file(0)).size(), 1u);
}

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
    if (!at_an_end) {
      ASSERT_EQ(series.gaps()[0].offset + series.gaps()[0].size, size);
    }
  }
}

}  // namespace
}  // namespace orchard::io
