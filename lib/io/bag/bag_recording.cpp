// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/bag_recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "io/bag/bag_picture.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

using ros::MessageType;
using ros::NotUsed;
using Decoded = std::variant<SensorMessage, NotUsed>;

constexpr std::int64_t kLongestStep_us = 1'000'000;

/// Position of a message that may be used.
struct Entry {
  std::int64_t utime = 0;
  BagPlace place;
  std::uint16_t file = 0;
  std::uint16_t topic = 0;  ///< index into Impl::topics
  std::uint8_t kind = 0;
  bool has_own_time = true;
};

template <class T>
Decoded as_sensor(std::variant<T, NotUsed> decoded) {
  if (auto* none = std::get_if<NotUsed>(&decoded)) return std::move(*none);
  return SensorMessage(std::move(std::get<T>(decoded)));
}

}  // namespace

struct BagRecording::Impl {
  struct Topic {
    FoundTopic found;
    MessageType type;
  };

  void index(std::size_t file, const std::function<void(std::uint64_t)>& progress);
  std::size_t topic_number(const BagTopic& topic);
  void choose(const BagOptions& options);
  Decoded decode(const Entry& entry, const BagMessage& message);
  Decoded decode_odometry(const BagMessage& message, ros::Wire wire);
  void ignore(std::size_t topic, const std::string& why);

  std::vector<std::string> paths;
  std::vector<std::unique_ptr<BagReader>> readers;
  std::vector<Topic> topics;
  std::array<std::string, kNumBagKinds> chosen;
  ros::CloudSlice slice;
  std::vector<Entry> entries;
  std::size_t position = 0;
  std::array<std::optional<std::int64_t>, kNumBagKinds> last_utime;
  std::optional<pose::PoseFix> last_place;
  std::map<std::string, std::int64_t> ignored;
};

std::size_t BagRecording::Impl::topic_number(const BagTopic& topic) {
  const auto known = std::find_if(topics.begin(), topics.end(), [&](const Topic& t) {
    return t.found.name == topic.name && t.found.type == topic.type &&
           t.found.is_known_wire == topic.is_known_wire;
  });
  if (known != topics.end()) return static_cast<std::size_t>(known - topics.begin());
  topics.push_back({{topic.name, topic.type, topic.is_known_wire, 0},
                    topic.is_known_wire ? ros::message_type(topic.type) : MessageType::kNone});
  return topics.size() - 1;
}

void BagRecording::Impl::ignore(std::size_t topic, const std::string& why) {
  constexpr std::size_t kMaxKinds = 200;
  const std::string kind = topics[topic].found.name.substr(0, 128) + ": " + why;
  const auto known = ignored.find(kind);
  if (known != ignored.end()) {
    ++known->second;
  } else if (ignored.size() < kMaxKinds) {
    ignored[kind] = 1;
  }
}

/// Examines every message of a file once.
void BagRecording::Impl::index(std::size_t file,
                               const std::function<void(std::uint64_t)>& progress) {
  constexpr std::size_t kMaxTopics = 60000;
  BagReader& reader = *readers[file];
  std::vector<std::size_t> number_of;  // index into topics by the reader's own index
  while (const auto message = reader.next()) {
    while (number_of.size() <= message->topic) {
      number_of.push_back(topic_number(reader.topics()[number_of.size()]));
    }
    const std::size_t topic = number_of[message->topic];
    ++topics[topic].found.num_messages;
    progress(reader.position());
    if (topics[topic].type == MessageType::kNone || topic > kMaxTopics) continue;
    const auto header =
        ros::decode_header(message->data, message->size, reader.topics()[message->topic].wire);
    if (const auto* none = std::get_if<NotUsed>(&header)) {
      ignore(topic, none->why);
      continue;
    }
    Entry entry;
    entry.utime = std::get<ros::Header>(header).utime;
    entry.has_own_time = entry.utime != 0;
    if (!entry.has_own_time) entry.utime = message->utime;
    entry.place = message->place;
    entry.file = static_cast<std::uint16_t>(file);
    entry.topic = static_cast<std::uint16_t>(topic);
    entries.push_back(entry);
  }
}

/// Keeps the messages of the chosen topics, in order of (time, kind, file, place).
void BagRecording::Impl::choose(const BagOptions& options) {
  std::vector<FoundTopic> found;
  for (const Topic& topic : topics) found.push_back(topic.found);
  try {
    chosen = choose_topics(found, options.topics);
  } catch (const FileError& error) {
    std::string lost;
    for (const auto& reader : readers) {
      if (lost.empty() && !reader->losses().empty()) lost = "; lost: " + reader->losses().front();
    }
    throw FileError(paths.front() + (paths.size() > 1 ? " and more" : "") + ": " + error.what() +
                    lost);
  }
  std::vector<Entry> kept;
  for (Entry entry : entries) {
    const Topic& topic = topics[entry.topic];
    for (std::size_t kind = 0; kind < kNumBagKinds; ++kind) {
      // One odometry topic can provide both velocities and poses.
      if (chosen[kind] != topic.found.name) continue;
      entry.kind = static_cast<std::uint8_t>(kind);
      kept.push_back(entry);
    }
  }
  entries = std::move(kept);
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.utime, a.kind, a.file, a.place.record, a.place.within) <
           std::tie(b.utime, b.kind, b.file, b.place.record, b.place.within);
  });
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const bool is_chosen =
        std::find(chosen.begin(), chosen.end(), topics[i].found.name) != chosen.end();
    if (!is_chosen) {
      ignored[topics[i].found.name + " (" + topics[i].found.type + ")"] +=
          topics[i].found.num_messages;
    }
  }
}

/// Returns the velocities; if the robot sends positions only, the mean over the step.
Decoded BagRecording::Impl::decode_odometry(const BagMessage& message, ros::Wire wire) {
  auto decoded = ros::decode_odometry(message.data, message.size, wire);
  if (auto* none = std::get_if<NotUsed>(&decoded)) return std::move(*none);
  auto& [velocity, place] = std::get<ros::Odometry>(decoded);
  const std::optional<pose::PoseFix> before = std::exchange(last_place, place);
  if (velocity.speed_mps != 0.0 || velocity.yaw_rate_radps != 0.0 || !before) {
    return SensorMessage(velocity);
  }
  const std::int64_t step_us = place.utime - before->utime;
  const double dx_m = place.x_m - before->x_m, dy_m = place.y_m - before->y_m;
  const double turn_rad = geometry::wrap_angle_rad(place.yaw_rad - before->yaw_rad);
  const bool has_moved = dx_m != 0.0 || dy_m != 0.0 || turn_rad != 0.0;
  if (!has_moved || step_us <= 0 || step_us > kLongestStep_us) return SensorMessage(velocity);
  const double step_s = 1e-6 * static_cast<double>(step_us);
  const double heading_rad = before->yaw_rad + turn_rad / 2;
  velocity.utime = before->utime + step_us / 2;
  velocity.speed_mps = (dx_m * std::cos(heading_rad) + dy_m * std::sin(heading_rad)) / step_s;
  velocity.yaw_rate_radps = turn_rad / step_s;
  velocity.covariance = {};  // the message's covariance is that of its twist
  return SensorMessage(velocity);
}

Decoded BagRecording::Impl::decode(const Entry& entry, const BagMessage& message) {
  const ros::Wire wire = readers[entry.file]->topics()[message.topic].wire;
  const void* data = message.data;
  const std::size_t size = message.size;
  switch (topics[entry.topic].type) {
    case MessageType::kLaserScan:
      return as_sensor(ros::decode_laser_scan(data, size, wire));
    case MessageType::kPointCloud2: {
      auto cloud = ros::decode_point_cloud(data, size, wire);
      if (auto* none = std::get_if<NotUsed>(&cloud)) return std::move(*none);
      auto& points = std::get<ros::PointCloud>(cloud);
      points.utime = entry.utime;
      return as_sensor(ros::slice_cloud(points, slice));
    }
    case MessageType::kImage:
    case MessageType::kCompressedImage: {
      auto picture = topics[entry.topic].type == MessageType::kImage
                         ? ros::decode_image(data, size, wire)
                         : ros::decode_compressed_image(data, size, wire);
      if (auto* none = std::get_if<NotUsed>(&picture)) return std::move(*none);
      return as_sensor(bag_picture(std::get<ros::Picture>(picture)));
    }
    case MessageType::kImu:
      return as_sensor(ros::decode_imu(data, size, wire));
    case MessageType::kNavSatFix:
      return as_sensor(ros::decode_nav_sat_fix(data, size, wire));
    case MessageType::kPose:
    case MessageType::kPoseWithCovariance:
      return as_sensor(ros::decode_pose(
          data, size, wire, topics[entry.topic].type == MessageType::kPoseWithCovariance));
    case MessageType::kOdometry: {
      if (static_cast<BagKind>(entry.kind) == BagKind::kOdometry) {
        return decode_odometry(message, wire);
      }
      auto odometry = ros::decode_odometry(data, size, wire);
      if (auto* none = std::get_if<NotUsed>(&odometry)) return std::move(*none);
      return SensorMessage(std::get<ros::Odometry>(odometry).place);
    }
    case MessageType::kNone:
      break;
  }
  return NotUsed{"of another type"};
}

BagRecording::BagRecording(const std::vector<std::string>& paths, const BagOptions& options,
                           const Progress& progress)
    : impl_(std::make_unique<Impl>()) {
  constexpr std::size_t kMaxFiles = 10000;
  if (paths.empty() || paths.size() > kMaxFiles) throw FileError("give 1 to 10000 bags");
  impl_->paths = paths;
  impl_->slice = options.slice;
  std::uint64_t total = 0, done = 0;
  for (const std::string& path : paths) {
    impl_->readers.push_back(open_bag(path));
    total += impl_->readers.back()->size();
  }
  for (std::size_t file = 0; file < paths.size(); ++file) {
    impl_->index(file, [&](std::uint64_t position) { progress(done + position, total); });
    done += impl_->readers[file]->size();
  }
  impl_->choose(options);
}

BagRecording::~BagRecording() = default;

std::optional<SensorMessage> BagRecording::next() {
  while (impl_->position < impl_->entries.size()) {
    const Entry& entry = impl_->entries[impl_->position++];
    const auto message = impl_->readers[entry.file]->at(entry.place);
    if (!message) {
      impl_->ignore(entry.topic, "cannot be read a second time");
      continue;
    }
    Decoded decoded = impl_->decode(entry, *message);
    if (auto* none = std::get_if<NotUsed>(&decoded)) {
      impl_->ignore(entry.topic, none->why);
      continue;
    }
    auto& sensed = std::get<SensorMessage>(decoded);
    if (!entry.has_own_time) {
      impl_->ignore(entry.topic, "without a time stamp of its own: used with the time of the bag");
      std::visit([&](auto& m) { m.utime = entry.utime; }, sensed);
    }
    if (static_cast<BagKind>(entry.kind) == BagKind::kScanRear) {
      sensed = laser::RearScan{std::move(std::get<laser::Scan>(sensed))};
    }
    auto& last = impl_->last_utime[entry.kind];
    if (last && utime_of(sensed) <= *last) {
      impl_->ignore(entry.topic, "the same time stamp as the message before");
      continue;
    }
    last = utime_of(sensed);
    return std::move(sensed);
  }
  return std::nullopt;
}

std::uint64_t BagRecording::num_messages() const { return impl_->entries.size(); }

std::vector<std::string> BagRecording::choices() const {
  std::vector<std::string> lines;
  for (std::size_t kind = 0; kind < kNumBagKinds; ++kind) {
    for (const Impl::Topic& topic : impl_->topics) {
      if (topic.found.name != impl_->chosen[kind]) continue;
      lines.push_back(std::string(kBagKindNames[kind]) + ": " + topic.found.name + " (" +
                      topic.found.type + ")");
    }
  }
  return lines;
}

std::map<std::string, std::int64_t> BagRecording::ignored() const { return impl_->ignored; }

std::vector<std::string> BagRecording::losses() const {
  std::vector<std::string> lines;
  for (std::size_t file = 0; file < impl_->readers.size(); ++file) {
    for (const std::string& loss : impl_->readers[file]->losses()) {
      lines.push_back(impl_->paths[file] + ": " + loss);
    }
  }
  return lines;
}

}  // namespace orchard::io
