// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/bag_recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "geometry/angles.hpp"
#include "io/bag/bag_picture.hpp"
#include "io/bag/bag_reader.hpp"
#include "io/bag/bag_rig.hpp"
#include "io/file_error.hpp"
#include "ros/frame_tree.hpp"
#include "ros/ros_messages.hpp"

namespace orchard::io {
namespace {

using ros::MessageType;
using Types = std::vector<MessageType>;
using ros::NotUsed;
using Decoded = std::variant<SensorMessage, NotUsed>;

/// Kinds of messages that a topic can be converted to, in the order of SensorMessage's
/// alternatives.
enum class BagKind { kScan, kImage, kOdometry, kGnss, kPoseFix, kImu, kScanRear };
constexpr std::size_t kNumBagKinds = 7;
constexpr std::array<const char*, kNumBagKinds> kBagKindNames{
    "scan", "image", "odometry", "gnss", "pose_fix", "imu", "scan_rear"};

/// Message types that can be converted to a kind; types of one group are equivalent.
const std::vector<Types>& types_of(BagKind kind) {
  using T = MessageType;
  static const std::vector<Types> kTypes[kNumBagKinds]{
      {{T::kLaserScan}, {T::kPointCloud2}},
      {{T::kImage, T::kCompressedImage}},
      {{T::kOdometry}, {T::kTransforms}},
      {{T::kNavSatFix}},
      {{T::kPose, T::kPoseWithCovariance, T::kOdometry}},
      {{T::kImu}},
      {{T::kLaserScan}, {T::kPointCloud2}}};
  return kTypes[static_cast<std::size_t>(kind)];
}

/// A topic found in a bag.
struct FoundTopic {
  std::string name;
  std::string type;
  bool is_known_wire = true;
  std::int64_t num_messages = 0;
  bool has_motion = true;  ///< of transforms: whether one of them moves
};

bool is_of(const FoundTopic& topic, const Types& types) {
  return topic.is_known_wire && topic.has_motion &&
         std::find(types.begin(), types.end(), ros::message_type(topic.type)) != types.end();
}

std::string list(const std::vector<FoundTopic>& topics) {
  constexpr std::size_t kShown = 30;
  std::string text;
  for (std::size_t i = 0; i < topics.size() && i < kShown; ++i) {
    text += (text.empty() ? "" : ", ") + topics[i].name + " (" +
            std::to_string(topics[i].num_messages) + " " +
            (topics[i].type.empty() ? "without a type" : topics[i].type) +
            (topics[i].is_known_wire ? "" : ", neither ROS 1 nor CDR") + ")";
  }
  if (topics.empty()) return "no messages";
  return text + (topics.size() > kShown ? ", ..." : "");
}

std::string named_topic(const std::string& kind_name, const std::string& name, BagKind kind,
                        const std::vector<FoundTopic>& topics) {
  const auto found = std::find_if(topics.begin(), topics.end(),
                                  [&](const FoundTopic& topic) { return topic.name == name; });
  if (found == topics.end()) {
    throw FileError("--topic " + kind_name + "=" + name +
                    ": this topic has no messages; the topics are " + list(topics));
  }
  for (const Types& types : types_of(kind)) {
    if (is_of(*found, types)) return name;
  }
  throw FileError("--topic " + kind_name + "=" + name + ": its type " + found->type +
                  " cannot be converted to this kind; the topics are " + list(topics));
}

std::string only_topic(const std::string& kind_name, BagKind kind,
                       const std::vector<FoundTopic>& topics) {
  for (const Types& types : types_of(kind)) {
    std::vector<FoundTopic> candidates;
    std::copy_if(topics.begin(), topics.end(), std::back_inserter(candidates),
                 [&](const FoundTopic& topic) { return is_of(topic, types); });
    if (candidates.size() > 1) {
      throw FileError("several topics can be " + kind_name + ": " + list(candidates) +
                      "; choose one with --topic " + kind_name + "=" + candidates.front().name +
                      ", or none with --topic " + kind_name + "=none");
    }
    if (!candidates.empty()) return candidates.front().name;
  }
  return "";
}

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

/// Chooses the topic of each kind: the one named in `wanted` ("none": no topic), else the only
/// topic with a type of this kind. A point cloud is chosen only if there is no scan. Poses and a
/// second scanner must be named. Empty: no topic for this kind. Throws FileError with the option to
/// use when the choice is ambiguous, a name does not exist or has the wrong type, or nothing is
/// chosen.
std::array<std::string, kNumBagKinds> choose_topics(
    const std::vector<FoundTopic>& topics, const std::map<std::string, std::string>& wanted) {
  std::array<std::string, kNumBagKinds> chosen;
  bool is_any = false;
  for (std::size_t i = 0; i < kNumBagKinds; ++i) {
    const auto kind = static_cast<BagKind>(i);
    const std::string name = kBagKindNames[i];
    const auto by_user = wanted.find(name);
    if (by_user != wanted.end()) {
      if (by_user->second != "none") chosen[i] = named_topic(name, by_user->second, kind, topics);
    } else if (kind != BagKind::kPoseFix && kind != BagKind::kScanRear) {
      chosen[i] = only_topic(name, kind, topics);
    }
    is_any = is_any || !chosen[i].empty();
  }
  if (is_any) return chosen;
  throw FileError(
      "no usable topic; supported are LaserScan, PointCloud2, Image, CompressedImage, Imu, "
      "NavSatFix and Odometry; the topics are " +
      list(topics));
}

}  // namespace

std::map<std::string, std::string> parse_topic_choices(const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> choices;
  for (const std::string& pair : pairs) {
    const std::size_t equals = pair.find('=');
    const std::string kind = pair.substr(0, equals);
    const bool is_kind =
        std::find(kBagKindNames.begin(), kBagKindNames.end(), kind) != kBagKindNames.end();
    if (equals == std::string::npos || !is_kind || equals + 1 == pair.size()) {
      std::string kinds;
      for (const char* name : kBagKindNames)
        kinds += (kinds.empty() ? "" : ", ") + std::string(name);
      throw FileError("--topic " + pair + ": must be KIND=TOPIC with KIND one of " + kinds);
    }
    choices[kind] = pair.substr(equals + 1);
  }
  return choices;
}

struct BagRecording::Impl {
  struct Topic {
    FoundTopic found;
    MessageType type;
    std::string frame;  ///< of its first message
  };

  void index(std::size_t file);
  void report(std::size_t file) const;
  std::size_t topic_number(const BagTopic& topic);
  void choose(const BagOptions& options);
  Decoded decode(const Entry& entry, const BagMessage& message);
  void note_frames(Topic& topic, const BagMessage& message, ros::Wire wire);
  void find_base();
  Decoded decode_motion(const BagMessage& message, ros::Wire wire);
  SensorMessage velocity_of(const ros::Odometry& odometry);
  const Topic* topic_of(BagKind kind) const;
  void ignore(std::size_t topic, const std::string& why);

  Progress progress;
  std::vector<std::string> paths;
  std::vector<std::unique_ptr<BagReader>> readers;
  std::vector<Topic> topics;
  std::array<std::string, kNumBagKinds> chosen;
  ros::CloudSlice slice;
  std::vector<Entry> entries;
  bool is_indexed = false;
  std::size_t position = 0;
  std::array<std::optional<std::int64_t>, kNumBagKinds> last_utime;
  std::optional<pose::PoseFix> last_place;
  ros::FrameTree frames;
  std::string odometry_frame;  ///< whose velocity the robot sends; empty: unknown
  std::string moving_frame;    ///< of the robot, in /tf
  std::optional<geometry::CameraIntrinsics> camera;
  std::map<std::string, std::int64_t> ignored;
};

std::size_t BagRecording::Impl::topic_number(const BagTopic& topic) {
  const auto known = std::find_if(topics.begin(), topics.end(), [&](const Topic& t) {
    return t.found.name == topic.name && t.found.type == topic.type &&
           t.found.is_known_wire == topic.is_known_wire;
  });
  if (known != topics.end()) return static_cast<std::size_t>(known - topics.begin());
  topics.push_back({{topic.name, topic.type, topic.is_known_wire, 0},
                    topic.is_known_wire ? ros::message_type(topic.type) : MessageType::kNone,
                    ""});
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
void BagRecording::Impl::index(std::size_t file) {
  constexpr std::size_t kMaxTopics = 60000;
  BagReader& reader = *readers[file];
  std::vector<std::size_t> number_of;  // index into topics by the reader's own index
  while (const auto message = reader.next()) {
    while (number_of.size() <= message->topic) {
      number_of.push_back(topic_number(reader.topics()[number_of.size()]));
    }
    const std::size_t topic = number_of[message->topic];
    ++topics[topic].found.num_messages;
    if (topics[topic].type == MessageType::kNone || topic > kMaxTopics) continue;
    const ros::Wire wire = reader.topics()[message->topic].wire;
    const auto header = ros::decode_header(message->data, message->size, wire, topics[topic].type);
    if (const auto* none = std::get_if<NotUsed>(&header)) {
      ignore(topic, none->why);
      continue;
    }
    if (topics[topic].frame.empty()) topics[topic].frame = std::get<ros::Header>(header).frame;
    note_frames(topics[topic], *message, wire);
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

/// Keeps what transforms, cameras and odometry tell about the rig.
void BagRecording::Impl::note_frames(Topic& topic, const BagMessage& message, ros::Wire wire) {
  if (topic.type == MessageType::kTransforms) {
    const auto decoded = ros::decode_transforms(message.data, message.size, wire);
    const auto* transforms = std::get_if<std::vector<ros::Transform>>(&decoded);
    if (transforms == nullptr) return;
    for (const ros::Transform& transform : *transforms) frames.add(transform);
  } else if (topic.type == MessageType::kCameraInfo && !camera) {
    const auto decoded = ros::decode_camera_info(message.data, message.size, wire);
    const auto* found = std::get_if<geometry::CameraIntrinsics>(&decoded);
    if (found != nullptr) camera = *found;
  } else if (topic.type == MessageType::kOdometry && odometry_frame.empty()) {
    const auto decoded = ros::decode_odometry(message.data, message.size, wire);
    const auto* odometry = std::get_if<ros::Odometry>(&decoded);
    if (odometry != nullptr) odometry_frame = odometry->base_frame;
  }
}

const BagRecording::Impl::Topic* BagRecording::Impl::topic_of(BagKind kind) const {
  const std::string& name = chosen[static_cast<std::size_t>(kind)];
  const auto found = std::find_if(topics.begin(), topics.end(),
                                  [&](const Topic& topic) { return topic.found.name == name; });
  return found != topics.end() ? &*found : nullptr;
}

/// Finds the frame that carries the scanners, and whether it moves in /tf.
void BagRecording::Impl::find_base() {
  for (const Topic& topic : topics) {
    const bool is_scan = topic.type == MessageType::kLaserScan;
    if (!is_scan && topic.type != MessageType::kPointCloud2) continue;
    moving_frame = frames.root_of(topic.frame);
    if (is_scan) break;
  }
  for (Topic& topic : topics) {
    if (topic.type != MessageType::kTransforms) continue;
    topic.found.has_motion =
        topic.found.name != "/tf_static" && !frames.world_of(moving_frame).empty();
  }
}

/// Reports progress while a file is read: in its bytes at first, then in messages.
void BagRecording::Impl::report(std::size_t file) const {
  if (is_indexed) return progress(position, entries.size());
  std::uint64_t total = 0, done = 0;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    total += readers[i]->size();
    if (i < file) done += readers[i]->size();
  }
  if (file < readers.size()) progress(done + readers[file]->position(), total);
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
    const bool tells_of_rig =
        topics[i].type == MessageType::kTransforms || topics[i].type == MessageType::kCameraInfo;
    if (!is_chosen && !tells_of_rig) {
      ignored[topics[i].found.name + " (" + topics[i].found.type + ")"] +=
          topics[i].found.num_messages;
    }
  }
}

/// The velocities; if the robot sends positions only, the mean since the position before.
SensorMessage BagRecording::Impl::velocity_of(const ros::Odometry& odometry) {
  pose::Odometry velocity = odometry.velocity;
  const pose::PoseFix& place = odometry.place;
  const std::optional<pose::PoseFix> before = std::exchange(last_place, place);
  if (velocity.speed_mps != 0.0 || velocity.yaw_rate_radps != 0.0 || !before) return velocity;
  const std::int64_t step_us = place.utime - before->utime;
  const double dx_m = place.x_m - before->x_m, dy_m = place.y_m - before->y_m;
  const double turn_rad = geometry::wrap_angle_rad(place.yaw_rad - before->yaw_rad);
  const bool has_moved = dx_m != 0.0 || dy_m != 0.0 || turn_rad != 0.0;
  if (!has_moved || step_us <= 0 || step_us > kLongestStep_us) return velocity;
  const double step_s = 1e-6 * static_cast<double>(step_us);
  const double heading_rad = before->yaw_rad + turn_rad / 2;
  velocity.speed_mps = (dx_m * std::cos(heading_rad) + dy_m * std::sin(heading_rad)) / step_s;
  velocity.yaw_rate_radps = turn_rad / step_s;
  velocity.covariance = {};  // the message's covariance is that of its twist
  return velocity;
}

/// The motion of base in /tf, from its pose in the frame of odometry.
Decoded BagRecording::Impl::decode_motion(const BagMessage& message, ros::Wire wire) {
  auto decoded = ros::decode_transforms(message.data, message.size, wire);
  if (auto* none = std::get_if<NotUsed>(&decoded)) return std::move(*none);
  for (const ros::Transform& t : std::get<std::vector<ros::Transform>>(decoded)) {
    if (t.child != moving_frame || t.parent != frames.world_of(moving_frame)) continue;
    ros::Odometry odometry;
    odometry.velocity.utime = odometry.place.utime = t.utime;
    odometry.place.x_m = t.T_parent_child.translation().x();
    odometry.place.y_m = t.T_parent_child.translation().y();
    odometry.place.yaw_rad = std::atan2(t.T_parent_child(1, 0), t.T_parent_child(0, 0));
    return velocity_of(odometry);
  }
  return NotUsed{"transforms of other frames"};
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
      auto odometry = ros::decode_odometry(data, size, wire);
      if (auto* none = std::get_if<NotUsed>(&odometry)) return std::move(*none);
      const auto& found = std::get<ros::Odometry>(odometry);
      if (static_cast<BagKind>(entry.kind) == BagKind::kOdometry) return velocity_of(found);
      return SensorMessage(found.place);
    }
    case MessageType::kTransforms:
      return decode_motion(message, wire);
    case MessageType::kCameraInfo:
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
  impl_->progress = progress;
  for (std::size_t file = 0; file < paths.size(); ++file) {
    impl_->readers.push_back(open_bag(paths[file], [this, file] { impl_->report(file); }));
  }
  for (std::size_t file = 0; file < paths.size(); ++file) impl_->index(file);
  impl_->find_base();
  impl_->choose(options);
  impl_->is_indexed = true;
}

BagRecording::~BagRecording() = default;

std::optional<SensorMessage> BagRecording::next() {
  while (impl_->position < impl_->entries.size()) {
    const Entry& entry = impl_->entries[impl_->position++];
    impl_->report(entry.file);
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

BagRig BagRecording::rig() const {
  const auto frame_of = [this](BagKind kind) {
    const Impl::Topic* topic = impl_->topic_of(kind);
    return topic != nullptr ? topic->frame : std::string();
  };
  BagFrames frames{impl_->odometry_frame, frame_of(BagKind::kScan), frame_of(BagKind::kScanRear),
                   frame_of(BagKind::kImage), frame_of(BagKind::kGnss)};
  if (!impl_->frames.between(frames.base, frames.scan)) frames.base = impl_->moving_frame;
  return bag_rig(impl_->frames, frames, impl_->camera);
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
