// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>

#include <numeric>

#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_repair.hpp"
#include "io/log/log_writer.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

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
      const auto events = read_text(bad);
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
  std::string log;
  for (int i = 0; i < 4; ++i) {  // 64 bytes each: 28 + 4 + 32
    const TestFolder folder;
    LogWriter writer(folder / "a.lcm");
    for (int k = 0; k < 4; ++k) writer.write(k, "SCAN", std::vector<std::uint8_t>(32, 7));
    writer.close();
    log = read_bytes(folder / "a.lcm");
  }
  log[64 + 27] = 32 + 64;  // the second swallows the third exactly
  std::vector<LogGap> gaps;
  const auto events = read_text(log, &gaps);
  ASSERT_THAT(events, SizeIs(3));
  EXPECT_EQ(events[1].event_number, 2);
  ASSERT_THAT(gaps, SizeIs(1));
  EXPECT_EQ(gaps[0].offset, 64u);
  EXPECT_EQ(gaps[0].size, 64u);
}

TEST(Log, ACutTailIsAGapAtTheEnd) {
  const TestFolder folder;
  const std::string good = write_log(folder / "a.lcm");
  const auto whole = read_text(good);
  for (std::size_t size = 0; size < good.size(); ++size) {
    std::vector<LogGap> gaps;
    const auto events = read_text(good.substr(0, size), &gaps);
    std::size_t num_whole = 0;
    while (num_whole + 1 < whole.size() && whole[num_whole + 1].offset <= size) ++num_whole;
    ASSERT_EQ(events.size(), num_whole) << size;
    const std::uint64_t end = whole[num_whole].offset;
    ASSERT_EQ(gaps.size(), end == size ? 0u : 1u) << size;
    if (!gaps.empty()) {
      ASSERT_EQ(gaps[0].offset + gaps[0].size, size);
    }
  }
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

}  // namespace
}  // namespace orchard::io
