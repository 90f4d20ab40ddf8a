// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/levelled_inputs.hpp"

#include <algorithm>
#include <type_traits>

#include "pose/pose_config.hpp"

namespace orchard::bus {
namespace {

bool uses_wheels(const io::Config& config) {
  const auto odometry = static_cast<std::size_t>(pose::MeasurementKind::kOdometry);
  return config.detector.use_odometry ||
         pose::expected_measurements(config.pose)[odometry].has_value();
}

}  // namespace

LevelledInputs::LevelledInputs(const io::Config& config) : has_wheels_(uses_wheels(config)) {
  if (config.laser.height_m <= 0.0) return;
  leveller_.emplace(pose::LevellingConfig{config.laser, config.laser_rear, has_wheels_,
                                          config.detector.segmentation});
}

bool LevelledInputs::reads(Channel channel) const {
  return leveller_ && (channel == Channel::kImu || (has_wheels_ && channel == Channel::kOdometry));
}

void LevelledInputs::add_channels(std::vector<Channel>& channels) const {
  for (const Channel channel : {Channel::kImu, Channel::kOdometry}) {
    const bool is_there = std::find(channels.begin(), channels.end(), channel) != channels.end();
    if (reads(channel) && !is_there) channels.push_back(channel);
  }
}

bool LevelledInputs::take(const Message& input) {
  return std::visit(
      [this](const auto& m) {
        if constexpr (std::is_constructible_v<pose::Leveller::Input, decltype(m)>) {
          leveller_->add(m);
          return true;
        } else {
          return false;
        }
      },
      input);
}

Message LevelledInputs::message(pose::Leveller::Input input) {
  return std::visit([](auto& m) { return Message(std::move(m)); }, input);
}

}  // namespace orchard::bus
