// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ros/ros_messages.hpp"

namespace orchard::io {

/// What a topic of a bag can become, in the order of SensorMessage's alternatives.
enum class BagKind { kScan, kImage, kOdometry, kGnss, kPoseFix, kImu, kScanRear };
inline constexpr std::size_t kNumBagKinds = 7;
inline constexpr std::array<const char*, kNumBagKinds> kBagKindNames{
    "scan", "image", "odometry", "gnss", "pose_fix", "imu", "scan_rear"};

/// A topic that some bag holds.
struct FoundTopic {
  std::string name;
  std::string type;
  bool is_known_wire = true;
  std::int64_t num_messages = 0;
};

/// Chooses the topic of each kind: the one that `wanted` names ("none": none), else the only one of
/// the kind's types; a cloud only where no scan is. Poses and a second scanner are taken only when
/// they are named. Empty: nothing becomes of this kind. Throws FileError, with what to write, when
/// several could be meant, a name is not there or of a type that does not fit, or nothing is left.
std::array<std::string, kNumBagKinds> choose_topics(
    const std::vector<FoundTopic>& topics, const std::map<std::string, std::string>& wanted);

/// Reads `KIND=TOPIC` pairs. Throws FileError for another kind or form.
std::map<std::string, std::string> parse_topic_choices(const std::vector<std::string>& pairs);

}  // namespace orchard::io
