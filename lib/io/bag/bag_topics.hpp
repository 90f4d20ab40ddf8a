// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ros/ros_messages.hpp"

namespace orchard::io {

/// Kinds of messages that a topic can be converted to, in the order of SensorMessage's
/// alternatives.
enum class BagKind { kScan, kImage, kOdometry, kGnss, kPoseFix, kImu, kScanRear };
inline constexpr std::size_t kNumBagKinds = 7;
inline constexpr std::array<const char*, kNumBagKinds> kBagKindNames{
    "scan", "image", "odometry", "gnss", "pose_fix", "imu", "scan_rear"};

/// A topic found in a bag.
struct FoundTopic {
  std::string name;
  std::string type;
  bool is_known_wire = true;
  std::int64_t num_messages = 0;
};

/// Chooses the topic of each kind: the one named in `wanted` ("none": no topic), else the only
/// topic with a type of this kind. A point cloud is chosen only if there is no scan. Poses and a
/// second scanner must be named. Empty: no topic for this kind. Throws FileError with the option to
/// use when the choice is ambiguous, a name does not exist or has the wrong type, or nothing is
/// chosen.
std::array<std::string, kNumBagKinds> choose_topics(
    const std::vector<FoundTopic>& topics, const std::map<std::string, std::string>& wanted);

/// Parses `KIND=TOPIC` pairs. Throws FileError for an unknown kind or another form.
std::map<std::string, std::string> parse_topic_choices(const std::vector<std::string>& pairs);

}  // namespace orchard::io
