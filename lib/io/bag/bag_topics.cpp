// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/bag_topics.hpp"

#include <algorithm>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

using ros::MessageType;
using Types = std::vector<MessageType>;

/// Message types that can be converted to a kind; types of one group are equivalent.
std::vector<Types> types_of(BagKind kind) {
  switch (kind) {
    case BagKind::kScan:
    case BagKind::kScanRear:
      return {{MessageType::kLaserScan}, {MessageType::kPointCloud2}};
    case BagKind::kImage:
      return {{MessageType::kImage, MessageType::kCompressedImage}};
    case BagKind::kOdometry:
      return {{MessageType::kOdometry}};
    case BagKind::kGnss:
      return {{MessageType::kNavSatFix}};
    case BagKind::kPoseFix:
      return {{MessageType::kPose, MessageType::kPoseWithCovariance, MessageType::kOdometry}};
    case BagKind::kImu:
      return {{MessageType::kImu}};
  }
  return {};
}

bool is_of(const FoundTopic& topic, const Types& types) {
  return topic.is_known_wire &&
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

}  // namespace

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

}  // namespace orchard::io
