// SPDX-License-Identifier: BSD-3-Clause
// orchard-log-player --verify on a log that recorded its derived messages: equal as it stands, and
// different as soon as one byte of one of them is another.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class Verify : public CliTest {
 protected:
  /// Writes a log as lcm-logger would have recorded it live: what the sensors said and what came
  /// of it.
  void SetUp() override {
    CliTest::SetUp();
    ASSERT_EQ(map(log(), {"--quiet"}).exit_code, 0);
    for (const std::string& part : {log(), path("map/derived.lcm")}) {
      io::LogReader reader(part);
      while (auto event = reader.next()) events_.push_back(std::move(*event));
    }
    std::stable_sort(events_.begin(), events_.end(),
                     [](const auto& a, const auto& b) { return a.timestamp_us < b.timestamp_us; });
  }

  Result verify() {
    io::LogWriter writer(path("recorded.lcm"));
    for (const io::LogEvent& event : events_) {
      writer.write(event.timestamp_us, event.channel, event.data);
    }
    writer.close();
    return run({ORCHARD_BUILD_DIR "/bin/orchard-log-player", "--in-process", "--verify", "--config",
                config(), path("recorded.lcm")});
  }

  /// The bytes of the middle message of a channel.
  std::vector<std::uint8_t>& middle_message(bus::Channel channel) {
    std::vector<io::LogEvent*> found;
    for (io::LogEvent& event : events_) {
      if (event.channel == bus::info(channel).name) found.push_back(&event);
    }
    return found.at(found.size() / 2)->data;
  }

  std::vector<io::LogEvent> events_;
};

TEST_F(Verify, TheRecordingItselfIsEqual) {
  const Result result = verify();
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("DETECTIONS"));
}

TEST_F(Verify, OneByteOfDetectionsIsFoundWhereverItStands) {
  std::vector<std::uint8_t>& bytes = middle_message(bus::Channel::kDetections);
  const std::vector<std::uint8_t> sound = bytes;
  ASSERT_GT(sound.size(), 40u);
  // in the type's hash, in utime, in seq, in the middle, and the last one
  for (const std::size_t at :
       {std::size_t{3}, std::size_t{15}, std::size_t{19}, sound.size() / 2, sound.size() - 1}) {
    bytes = sound;
    bytes[at] ^= 1;
    const Result result = verify();
    EXPECT_EQ(result.exit_code, 1) << "byte " << at << ": " << result.out << result.err;
    EXPECT_THAT(result.out, HasSubstr("first difference: DETECTIONS")) << "byte " << at;
  }
}

TEST_F(Verify, OneByteOfPoseOrMapIsFound) {
  for (const bus::Channel channel : {bus::Channel::kPose, bus::Channel::kMap}) {
    std::vector<std::uint8_t>& bytes = middle_message(channel);
    bytes[bytes.size() / 2] ^= 0x10;
    const Result result = verify();
    EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
    EXPECT_THAT(result.out, HasSubstr("first difference: " + std::string(bus::info(channel).name)));
    bytes[bytes.size() / 2] ^= 0x10;
  }
}

TEST_F(Verify, AMissingMessageIsFound) {
  const std::vector<std::uint8_t> lost = middle_message(bus::Channel::kDetections);
  events_.erase(std::find_if(events_.begin(), events_.end(),
                             [&lost](const io::LogEvent& event) { return event.data == lost; }));
  const Result result = verify();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("not in the log"));
}

}  // namespace
}  // namespace orchard::cli_test
