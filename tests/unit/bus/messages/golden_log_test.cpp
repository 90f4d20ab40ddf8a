// SPDX-License-Identifier: BSD-3-Clause
// Logs of every release must stay readable: see tests/data/README.md.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "bus/messages/codec.hpp"
#include "bus/messages/fields.hpp"
#include "bus/messages/service_fields.hpp"
#include "io/log/log_reader.hpp"
#include "unit/bus/messages/field_values.hpp"

namespace orchard::bus {
namespace {

/// Channels of the first release; what came later has a log of its own.
constexpr std::size_t kNumFirstChannels = 12;

/// Decoded values by name, as text with every digit, and how many messages each channel has.
struct Values {
  std::map<std::string, std::string> texts;
  std::map<std::string, int> counts;
};

template <class M>
void put(Values& values, const std::string& channel, const M& message) {
  testing::FieldValues fields(values.texts, channel);
  visit_fields(message, fields);
}

template <class Decoded, class Put>
void expect_decoded(const Decoded& result, Put put_message) {
  if (const auto* rejection = std::get_if<Rejection>(&result)) {
    ADD_FAILURE() << to_string(rejection->reason) << ": " << rejection->detail;
  } else {
    put_message(std::get<0>(result));
  }
}

void put_event(Values& values, Channel channel, const std::vector<std::uint8_t>& data) {
  const std::string name(info(channel).name);
  const auto put_service = [&](const auto& message) { put(values, name, message); };
  switch (channel) {
    case Channel::kStatus:
      return expect_decoded(decode_status(data.data(), data.size()), put_service);
    case Channel::kConfig:
      return expect_decoded(decode_config(data.data(), data.size()), put_service);
    case Channel::kAck:
      return expect_decoded(decode_ack(data.data(), data.size()), put_service);
    case Channel::kReplay:
      return expect_decoded(decode_replay(data.data(), data.size()), put_service);
    default:
      return expect_decoded(decode(channel, data.data(), data.size()),
                            [&](const Message& message) { std::visit(put_service, message); });
  }
}

std::map<std::string, std::string> read_truth(const std::string& path) {
  std::map<std::string, std::string> truth;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t blank = line.find(' ');
    if (line.empty() || line[0] == '#') continue;
    truth[line.substr(0, blank)] = line.substr(blank + 1);
  }
  return truth;
}

/// Decodes every message of a golden log and compares it with what the text beside it states.
void expect_stays_readable(const std::string& name, std::size_t num_channels) {
  const std::string folder = ORCHARD_SOURCE_DIR "/tests/data/";
  Values values;
  io::LogReader reader(folder + name + ".lcm");
  while (const auto event = reader.next()) {
    const auto channel = find_channel(event->channel);
    if (event->channel == "ADAPTATION") continue;  // no longer sent; old logs hold it
    ASSERT_TRUE(channel.has_value()) << event->channel;
    values.texts[event->channel + ".count"] = std::to_string(++values.counts[event->channel]);
    put_event(values, *channel, event->data);
    EXPECT_EQ(event->timestamp_us, std::stoll(values.texts.at(event->channel + ".utime")));
  }
  EXPECT_TRUE(reader.gaps().empty());
  EXPECT_LT(reader.file_size(), 60000u);
  const auto truth = read_truth(folder + name + ".txt");
  std::size_t num_counts = 0;
  for (const auto& [key, text] : truth) {
    num_counts += key.find(".count") != std::string::npos;
    const auto found = values.texts.find(key);
    ASSERT_NE(found, values.texts.end()) << key << " was not decoded";
    EXPECT_EQ(found->second, text) << key;
  }
  EXPECT_EQ(num_counts, num_channels);
  EXPECT_GT(truth.size(), 15 * num_counts / 2);
}

TEST(GoldenLog, LogsOfTheFirstReleaseStayReadable) {
  expect_stays_readable("golden", kNumFirstChannels);
}

TEST(GoldenLog, LogsOfLaterTypesStayReadable) {
  expect_stays_readable("golden_2", 1);
  expect_stays_readable("golden_3", 2);
}

TEST(GoldenLog, OlderFormsAreGuardedAsTheNewOnesAre) {
  io::LogReader reader(ORCHARD_SOURCE_DIR "/tests/data/golden.lcm");
  std::vector<std::uint8_t> bytes;
  while (const auto event = reader.next()) {
    if (event->channel == info(Channel::kDetections).name) bytes = event->data;
  }
  ASSERT_FALSE(bytes.empty());
  const auto reason_of = [](const std::vector<std::uint8_t>& data) {
    return std::get<Rejection>(decode(Channel::kDetections, data.data(), data.size())).reason;
  };
  std::vector<std::uint8_t> many = bytes;
  many[20] = 0x7f;  // the highest byte of num_trunks
  EXPECT_EQ(reason_of(many), Reason::kBadCount);
  many[20] = 0xff;
  EXPECT_EQ(reason_of(many), Reason::kBadCount);
  EXPECT_EQ(reason_of({bytes.begin(), bytes.end() - 1}), Reason::kBadCount);
  EXPECT_EQ(reason_of({bytes.begin(), bytes.begin() + 31}), Reason::kTooShort);
  // On another channel they are of a wrong type.
  EXPECT_EQ(std::get<Rejection>(decode(Channel::kPose, bytes.data(), bytes.size())).reason,
            Reason::kWrongType);
}

}  // namespace
}  // namespace orchard::bus
