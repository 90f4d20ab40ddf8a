// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_recorder.hpp"

#include "io/file_error.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

class LogRecorderTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(testing::TempDir()) /
        (std::string("recorder_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    limits_.least_free_bytes = 0;
  }
  std::string stem() const { return (folder_ / "drive").string(); }
  std::string file(int number) const {
    char name[32];
    std::snprintf(name, sizeof(name), "drive-%03d.lcm", number);
    return (folder_ / name).string();
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
  fs::path folder_;
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
  for (const auto& entry : fs::directory_iterator(folder_)) total += entry.file_size();
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

}  // namespace
}  // namespace orchard::io
