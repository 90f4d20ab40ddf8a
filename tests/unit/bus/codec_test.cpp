// SPDX-License-Identifier: BSD-3-Clause

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "bus/messages/codec.hpp"
#include "bus/messages/fields.hpp"
#include "bus/messages/service_messages.hpp"
#include "io/log/log_reader.hpp"
#include "orchard/detections_t.hpp"
#include "orchard/detections_v2_t.hpp"
#include "orchard/map_tile_t.hpp"
#include "orchard/scan_t.hpp"
#include "unit/bus/field_visitors.hpp"
#include "unit/bus/sample_messages.hpp"

namespace orchard::bus {
namespace {

using testing::jpeg_head;
using testing::sample_messages;

std::optional<Reason> reason_of(Channel channel, const std::vector<std::uint8_t>& bytes) {
  const auto result = decode(channel, bytes.data(), bytes.size());
  if (const auto* rejection = std::get_if<Rejection>(&result)) return rejection->reason;
  return std::nullopt;
}

TEST(Codec, RoundTripKeepsEveryByte) {
  for (const Message& message : sample_messages()) {
    const std::vector<std::uint8_t> bytes = encode(message);
    const auto result = decode(channel_of(message), bytes.data(), bytes.size());
    ASSERT_TRUE(std::holds_alternative<Message>(result))
        << info(channel_of(message)).name << ": " << std::get<Rejection>(result).detail;
    EXPECT_EQ(encode(std::get<Message>(result)), bytes) << info(channel_of(message)).name;
    EXPECT_EQ(utime_of(std::get<Message>(result)), utime_of(message));
    EXPECT_EQ(seq_of(std::get<Message>(result)), seq_of(message));
  }
}

TEST(Codec, RoundTripKeepsFields) {
  const auto messages = sample_messages();
  const auto bytes = encode(messages[6]);
  const auto result = decode(Channel::kDetections, bytes.data(), bytes.size());
  const auto& was = std::get<detection::Detections>(messages[6]).trunks[1];
  const auto& is = std::get<detection::Detections>(std::get<Message>(result)).trunks.at(1);
  EXPECT_EQ(is.width_m, was.width_m);
  EXPECT_EQ(is.roc_tree, was.roc_tree);
  EXPECT_EQ(is.label, was.label);
  EXPECT_EQ(is.occlusion, was.occlusion);
  EXPECT_EQ(is.covariance, was.covariance);
}

template <class Fields, class M>
std::int64_t hash_of(Fields, const M& message) {
  testing::TypeHash hash;
  Fields::visit(message, hash);
  return hash.value();
}

TEST(Codec, FieldsAreThoseOfTheLcmFiles) {
  for (const Message& message : sample_messages()) {
    const Channel channel = channel_of(message);
    const auto hash = [](const auto& m) { return hash_of(fields_of(m), m); };
    EXPECT_EQ(std::visit(hash, message), type_hash(channel)) << info(channel).name;
  }
  EXPECT_EQ(hash_of(StatusFields{}, Status{}), type_hash(Channel::kStatus));
  EXPECT_EQ(hash_of(ConfigNoticeFields{}, ConfigNotice{}), type_hash(Channel::kConfig));
  EXPECT_EQ(hash_of(AckFields{}, Ack{}), type_hash(Channel::kAck));
  EXPECT_EQ(hash_of(ReplayMarkFields{}, ReplayMark{}), type_hash(Channel::kReplay));
  EXPECT_EQ(hash_of(detection::DetectionsFields<true>{}, detection::Detections{}),
            detections_t::getHash());
}

/// What the generated type of LCM reads from the bytes of a sample.
template <class Wire>
Wire read_by_lcm(Channel channel) {
  const auto bytes = encode(sample_messages()[static_cast<std::size_t>(channel)]);
  Wire wire;
  const int size = static_cast<int>(bytes.size());
  EXPECT_EQ(wire.decode(bytes.data(), 0, size), size);
  std::vector<std::uint8_t> again(bytes.size());
  EXPECT_EQ(wire.encode(again.data(), 0, size), size);
  EXPECT_EQ(again, bytes);
  return wire;
}

TEST(Codec, BytesAreThoseOfLcm) {
  const auto messages = sample_messages();
  const auto& scan = std::get<laser::Scan>(messages[0]);
  const auto wire_scan = read_by_lcm<scan_t>(Channel::kScan);
  EXPECT_EQ(wire_scan.range_max_m, scan.range_max_m);
  EXPECT_EQ(wire_scan.ranges_m, scan.ranges_m);
  EXPECT_EQ(wire_scan.intensities, scan.intensities);
  const auto& trunk = std::get<detection::Detections>(messages[6]).trunks[2];
  const auto wire_trunk = read_by_lcm<detections_v2_t>(Channel::kDetections).trunks.at(2);
  EXPECT_EQ(wire_trunk.utime, trunk.utime);
  EXPECT_EQ(wire_trunk.roc_tree, trunk.roc_tree);
  EXPECT_EQ(wire_trunk.occlusion, trunk.occlusion);
  const auto& tile = std::get<mapping::MapTile>(messages[7]);
  const auto wire_tile = read_by_lcm<map_tile_t>(Channel::kMap);
  EXPECT_EQ(wire_tile.landmarks.at(1).position, tile.landmarks[1].position);
  EXPECT_EQ(wire_tile.removed_ids, tile.removed_ids);
}

TEST(Codec, AnotherTypeIsRefused) {
  const auto messages = sample_messages();
  for (const Message& message : messages) {
    for (const ChannelInfo& channel : kChannels) {
      if (channel.role == Role::kService || channel.type == info(channel_of(message)).type)
        continue;
      EXPECT_EQ(reason_of(channel.channel, encode(message)), Reason::kWrongType);
    }
  }
}

TEST(Codec, EveryTruncationAndExtensionIsRefused) {
  for (const Message& message : sample_messages()) {
    std::vector<std::uint8_t> bytes = encode(message);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      // a copy of exactly this size, so that a sanitizer sees any read beyond it
      EXPECT_TRUE(reason_of(channel_of(message), {bytes.begin(), bytes.begin() + size}))
          << info(channel_of(message)).name << " cut to " << size;
    }
    bytes.push_back(0);
    EXPECT_EQ(reason_of(channel_of(message), bytes), Reason::kBadCount);
  }
}

TEST(Codec, EveryFlippedBitIsRefusedOrDecodesToSomethingValid) {
  for (const Message& message : sample_messages()) {
    const std::vector<std::uint8_t> bytes = encode(message);
    for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
      std::vector<std::uint8_t> flipped = bytes;
      flipped[i / 8] ^= static_cast<std::uint8_t>(1 << i % 8);
      const auto result = decode(channel_of(message), flipped.data(), flipped.size());
      if (const auto* decoded = std::get_if<Message>(&result)) {
        EXPECT_EQ(encode(*decoded), flipped);  // nothing was repaired on the way
      }
    }
  }
}

TEST(Codec, HugeCountOfTwentyBytesIsRefusedBeforeAllocation) {
  for (const Channel channel :
       {Channel::kScan, Channel::kImage, Channel::kDetections, Channel::kMap}) {
    const auto messages = sample_messages();
    std::vector<std::uint8_t> bytes = encode(messages[static_cast<std::size_t>(channel)]);
    for (const std::uint32_t count : {0x7FFFFFFFu, 0xFFFFFFFFu, 0x80000000u, 0x20000000u}) {
      for (int i = 0; i < 4; ++i) bytes[20 + i] = static_cast<std::uint8_t>(count >> (24 - 8 * i));
      EXPECT_EQ(reason_of(channel, bytes), Reason::kBadCount) << info(channel).name;
      EXPECT_EQ(reason_of(channel, {bytes.begin(), bytes.begin() + 24}), Reason::kTooShort);
    }
  }
}

TEST(Codec, SizeOfARuntDatagramIsRefusedWithoutAccess) {
  // LCM hands over a size of about 4 GB with it; nothing may be read.
  const std::uint8_t byte = 0;
  const auto result = decode(Channel::kScan, &byte, 0xFFFFFFF4u);
  EXPECT_EQ(std::get<Rejection>(result).reason, Reason::kTooLarge);
  EXPECT_EQ(std::get<Rejection>(decode(Channel::kScan, nullptr, 0)).reason, Reason::kTooShort);
}

TEST(Codec, ServiceChannelsHaveTheirOwnDecoders) {
  EXPECT_THROW(decode(Channel::kStatus, nullptr, 0), std::invalid_argument);
}

Message sample_of(Channel channel) {
  for (Message& message : sample_messages()) {
    if (channel_of(message) == channel) return message;
  }
  throw std::invalid_argument("no sample of this channel");
}

struct Spoilt {
  const char* what;
  Channel channel;
  std::function<void(Message&)> spoil;
  Reason reason;
};

template <class Type>
std::function<void(Message&)> on(std::function<void(Type&)> change) {
  return [change](Message& message) { change(std::get<Type>(message)); };
}

TEST(Codec, ContentThatCannotBeIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  using detection::Detections;
  using Imu = pose::Imu;
  using Page = pose::TrajectoryPage;
  using laser::Scan;
  using mapping::MapTile;
  using mapping::MapWays;
  using pose::Gnss;
  using pose::Odometry;
  using pose::PoseEstimate;
  using pose::PoseFix;
  using vision::Encoding;
  using vision::Image;
  const std::vector<Spoilt> cases{
      {"utime < 0", Channel::kScan, on<Scan>([](Scan& m) { m.utime = -1; }), Reason::kOutOfRange},
      {"seq < 0", Channel::kOdometry, on<Odometry>([](Odometry& m) { m.seq = -1; }),
       Reason::kOutOfRange},
      {"no beams", Channel::kScan, on<Scan>([](Scan& m) {
         m.ranges_m.clear();
         m.intensities.clear();
       }),
       Reason::kOutOfRange},
      {"step 0", Channel::kScan, on<Scan>([](Scan& m) { m.bearing_step_rad = 0; }),
       Reason::kOutOfRange},
      {"step nan", Channel::kScan, on<Scan>([nan](Scan& m) { m.bearing_step_rad = nan; }),
       Reason::kNotFinite},
      {"more than a turn", Channel::kScan, on<Scan>([](Scan& m) { m.bearing_step_rad = 3.2; }),
       Reason::kOutOfRange},
      {"limits crossed", Channel::kScan, on<Scan>([](Scan& m) { m.range_max_m = 0.01; }),
       Reason::kInconsistent},
      {"range < 0", Channel::kScan, on<Scan>([](Scan& m) { m.ranges_m[1] = -1; }),
       Reason::kOutOfRange},
      {"range of 101 km", Channel::kScan, on<Scan>([](Scan& m) { m.ranges_m[1] = 1.01e5f; }),
       Reason::kOutOfRange},
      {"range < 0 beside inf", Channel::kScan, on<Scan>([inf](Scan& m) {
         m.ranges_m[0] = static_cast<float>(inf);
         m.ranges_m[1] = -1;
       }),
       Reason::kOutOfRange},
      {"intensity nan", Channel::kScan,
       on<Scan>([nan](Scan& m) { m.intensities[1] = static_cast<float>(nan); }),
       Reason::kNotFinite},
      {"farthest inf", Channel::kScan, on<Scan>([inf](Scan& m) { m.range_max_m = inf; }),
       Reason::kNotFinite},
      {"intensities", Channel::kScan, on<Scan>([](Scan& m) { m.intensities.pop_back(); }),
       Reason::kInconsistent},
      {"no width", Channel::kImage, on<Image>([](Image& m) { m.width_px = 0; }),
       Reason::kOutOfRange},
      {"not the JPEG's size", Channel::kImage, on<Image>([](Image& m) { m.width_px = 640; }),
       Reason::kInconsistent},
      {"not a JPEG", Channel::kImage, on<Image>([](Image& m) { m.data[1] = 0; }),
       Reason::kInconsistent},
      {"JPEG cut before its frame", Channel::kImage, on<Image>([](Image& m) { m.data.resize(12); }),
       Reason::kInconsistent},
      {"raw of another size", Channel::kImage, on<Image>([](Image& m) {
         m.encoding = Encoding::kBgr8;
         m.data.resize(3 * 320 * 240 - 1);
       }),
       Reason::kInconsistent},
      {"encoding", Channel::kImage,
       on<Image>([](Image& m) { m.encoding = static_cast<Encoding>(9); }), Reason::kOutOfRange},
      {"variance < 0", Channel::kOdometry, on<Odometry>([](Odometry& m) { m.covariance[2] = -1; }),
       Reason::kOutOfRange},
      {"speed inf", Channel::kOdometry, on<Odometry>([inf](Odometry& m) { m.speed_mps = inf; }),
       Reason::kNotFinite},
      {"latitude 400", Channel::kGnss, on<Gnss>([](Gnss& m) { m.latitude_deg = 400; }),
       Reason::kOutOfRange},
      {"quality", Channel::kGnss, on<Gnss>([](Gnss& m) { m.fix_quality = -1; }),
       Reason::kOutOfRange},
      {"x nan", Channel::kPoseFix, on<PoseFix>([nan](PoseFix& m) { m.x_m = nan; }),
       Reason::kNotFinite},
      {"yaw 4", Channel::kPose, on<PoseEstimate>([](PoseEstimate& m) { m.yaw_rad = 4; }),
       Reason::kOutOfRange},
      {"roc 1.5", Channel::kDetections,
       on<Detections>([](Detections& m) { m.trunks[1].roc_tree = 1.5f; }), Reason::kOutOfRange},
      {"probabilities 1.4", Channel::kDetections, on<Detections>([](Detections& m) {
         m.trunks[0].probability_tree = m.trunks[0].probability_object = 0.7f;
       }),
       Reason::kOutOfRange},
      {"width < 0", Channel::kDetections,
       on<Detections>([](Detections& m) { m.trunks[0].width_m = -0.1; }), Reason::kOutOfRange},
      {"label 3", Channel::kDetections,
       on<Detections>([](Detections& m) { m.trunks[0].label = static_cast<detection::Label>(3); }),
       Reason::kOutOfRange},
      {"probability nan", Channel::kMap,
       on<MapTile>([nan](MapTile& m) { m.landmarks[0].probability = nan; }), Reason::kNotFinite},
      {"total < 0", Channel::kMap, on<MapTile>([](MapTile& m) { m.num_landmarks_total = -1; }),
       Reason::kOutOfRange},
      {"more points than ways have", Channel::kMapWays,
       on<MapWays>([](MapWays& m) { m.ways[1].num_points = 0; }), Reason::kInconsistent},
      {"part after the last", Channel::kMapWays,
       on<MapWays>([](MapWays& m) { m.part = m.num_parts; }), Reason::kOutOfRange},
      {"kind 2", Channel::kMapWays,
       on<MapWays>([](MapWays& m) { m.ways[0].edge.kind = static_cast<mapping::EdgeKind>(2); }),
       Reason::kOutOfRange},
      {"width < 0", Channel::kMapWays, on<MapWays>([](MapWays& m) { m.ways[0].edge.width_m = -1; }),
       Reason::kOutOfRange},
      {"rate nan", Channel::kImu, on<Imu>([nan](Imu& m) { m.angular_rate_radps[1] = nan; }),
       Reason::kNotFinite},
      {"variance < 0", Channel::kImu, on<Imu>([](Imu& m) { m.acceleration_variance = -1; }),
       Reason::kOutOfRange},
      {"page after the last", Channel::kTrajectory, on<Page>([](Page& m) { m.page = m.num_pages; }),
       Reason::kOutOfRange},
      {"revision 0", Channel::kTrajectory, on<Page>([](Page& m) { m.revision = 0; }),
       Reason::kOutOfRange},
      {"pose inf", Channel::kTrajectory, on<Page>([inf](Page& m) { m.poses[1].x_m = inf; }),
       Reason::kNotFinite},
      {"point nan", Channel::kMapWays, on<MapWays>([nan](MapWays& m) { m.points[2].y_m = nan; }),
       Reason::kNotFinite},
  };
  for (const Spoilt& spoilt : cases) {
    Message message = sample_of(spoilt.channel);
    spoilt.spoil(message);
    EXPECT_EQ(reason_of(spoilt.channel, encode(message)), spoilt.reason) << spoilt.what;
  }
  std::vector<std::uint8_t> bytes = encode(sample_of(Channel::kPose));
  const std::uint8_t of_2200[] = {0x00, 0x19, 0xC9, 0x38, 0x60, 0xF8, 0x40, 0x00};
  std::copy(std::begin(of_2200), std::end(of_2200), bytes.begin() + 8);
  EXPECT_EQ(reason_of(Channel::kPose, bytes), Reason::kOutOfRange);
}

TEST(Codec, OfADriveTimeTheUtimeIsSent) {
  Message message = sample_of(Channel::kDetections);
  const std::vector<std::uint8_t> sent = encode(message);
  set_drive_time(message, 3 * timing::kEpoch_us + utime_of(message));
  EXPECT_EQ(encode(message), sent) << "all its times are of one epoch";
  EXPECT_EQ(timing::epoch_of(utime_of(message)), 3);
}

TEST(Codec, RangesThatAreNotFiniteAreNoReturnAndStayAsSent) {
  const float inf = std::numeric_limits<float>::infinity();
  for (const float nothing : {inf, -inf, std::numeric_limits<float>::quiet_NaN()}) {
    auto scan = std::get<laser::Scan>(sample_of(Channel::kScan));
    scan.range_min_m = 0.1;
    ASSERT_TRUE(scan.valid(1));
    scan.ranges_m[1] = nothing;
    const std::vector<std::uint8_t> bytes = encode(scan);
    const auto result = decode(Channel::kScan, bytes.data(), bytes.size());
    ASSERT_TRUE(std::holds_alternative<Message>(result)) << std::get<Rejection>(result).detail;
    const auto& decoded = std::get<laser::Scan>(std::get<Message>(result));
    EXPECT_FALSE(decoded.valid(1));
    EXPECT_TRUE(decoded.valid(2));
    EXPECT_EQ(encode(decoded), bytes);  // nothing was repaired on the way
  }
}

TEST(Codec, HasYawIsZeroOrOne) {
  std::vector<std::uint8_t> bytes = encode(sample_messages()[4]);
  bytes.back() = 2;
  EXPECT_EQ(reason_of(Channel::kPoseFix, bytes), Reason::kUndecodable);
}

TEST(Codec, RawPicturesPassWithTheirExactSize) {
  auto image = std::get<vision::Image>(sample_messages()[1]);
  image.encoding = vision::Encoding::kGray8;
  image.data.assign(320 * 240, 7);
  EXPECT_EQ(reason_of(Channel::kImage, encode(image)), std::nullopt);
  image.encoding = vision::Encoding::kBgr8;
  image.data.assign(3 * 320 * 240, 7);
  EXPECT_EQ(reason_of(Channel::kImage, encode(image)), std::nullopt);
}

TEST(Codec, EveryReasonHasAName) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kNumReasons; ++i) names.insert(to_string(static_cast<Reason>(i)));
  EXPECT_EQ(names.size(), kNumReasons);
}

Status sample_status() {
  Status status;
  status.utime = 1700000000000000;
  status.seq = 5;
  status.level = Level::kWarning;
  status.num_good = 10;
  status.latency_max_s = 0.25;
  status.name = "orchard-detector";
  status.host = "robot";
  status.text = "waits";
  return status;
}

const Ack kAckSample{1700000000000000, 4, 2, Channel::kDetections, {{Channel::kMap, 9}}};

/// Every truncation, extension and flipped bit is refused or decodes; none crashes.
template <class Decode>
void expect_survives(const std::vector<std::uint8_t>& bytes, Decode decode) {
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + size);
    EXPECT_TRUE(std::holds_alternative<Rejection>(decode(cut.data(), cut.size()))) << size;
  }
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    std::vector<std::uint8_t> flipped = bytes;
    flipped[i / 8] ^= static_cast<std::uint8_t>(1 << i % 8);
    decode(flipped.data(), flipped.size());
  }
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode(longer.data(), longer.size())));
}

TEST(ServiceMessages, StatusRoundTrip) {
  const auto bytes = encode(sample_status());
  const auto status = std::get<Status>(decode_status(bytes.data(), bytes.size()));
  EXPECT_EQ(encode(status), bytes);
  EXPECT_EQ(status.text, "waits");
  EXPECT_EQ(status.level, Level::kWarning);
  expect_survives(bytes, decode_status);
}

TEST(ServiceMessages, ConfigRoundTrip) {
  const auto bytes = encode(ConfigNotice{17, 1, -5, "orchard-pose", "0.1.0", "lcm:\n  url: x\n"});
  const auto notice = std::get<ConfigNotice>(decode_config(bytes.data(), bytes.size()));
  EXPECT_EQ(notice.hash, -5);
  EXPECT_EQ(notice.text, "lcm:\n  url: x\n");
  expect_survives(bytes, decode_config);
}

TEST(ServiceMessages, AckRoundTrip) {
  const auto bytes = encode(kAckSample);
  const auto ack = std::get<Ack>(decode_ack(bytes.data(), bytes.size()));
  EXPECT_EQ(ack.node, 2);
  ASSERT_EQ(ack.outputs.size(), 1u);
  EXPECT_EQ(ack.outputs[0].channel, Channel::kMap);
  EXPECT_EQ(ack.outputs[0].seq, 9);
  expect_survives(bytes, decode_ack);
}

TEST(ServiceMessages, AckOfAnUnknownNodeOrChannelIsRefused) {
  Ack ack = kAckSample;
  ack.node = kNumInLockstep;
  auto bytes = encode(ack);
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_ack(bytes.data(), bytes.size())));
  ack = kAckSample;
  ack.outputs[0].channel = static_cast<Channel>(kNumChannels);
  bytes = encode(ack);
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_ack(bytes.data(), bytes.size())));
}

TEST(ServiceMessages, ReplayRoundTrip) {
  const auto bytes = encode(ReplayMark{17, 2, true});
  const auto mark = std::get<ReplayMark>(decode_replay(bytes.data(), bytes.size()));
  EXPECT_TRUE(mark.end);
  EXPECT_EQ(mark.seq, 2);
  expect_survives(bytes, decode_replay);
}

TEST(ServiceMessages, StringOfLengthZeroIsRefused) {
  // The generated decoder would make a string of -1 bytes of it.
  Status status = sample_status();
  status.name.clear();
  auto bytes = encode(status);
  bytes[93 + 3] = 0;
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_status(bytes.data(), bytes.size())));
}

TEST(ServiceMessages, StringWithAZeroInsideIsRefused) {
  auto bytes = encode(sample_status());
  bytes[93 + 4 + 3] = 0;
  EXPECT_TRUE(std::holds_alternative<Rejection>(decode_status(bytes.data(), bytes.size())));
}

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
