// SPDX-License-Identifier: BSD-3-Clause
#include "cli/maps/no_pose.hpp"

#include <algorithm>

namespace orchard::cli {
namespace {

using pose::PoseMode;

const char* mode_text(PoseMode mode) {
  switch (mode) {
    case PoseMode::kFixes:
      return "fixes";
    case PoseMode::kFixesAndOdometry:
      return "fixes_and_odometry";
    case PoseMode::kOdometry:
      return "odometry";
    case PoseMode::kStationary:
      return "stationary";
    case PoseMode::kFused:
      return "fused";
    case PoseMode::kPriorMap:
      return "prior_map";
    case PoseMode::kSlam:
      break;
  }
  return "slam";
}

bool can_read_scans(PoseMode mode) {
  return mode == PoseMode::kOdometry || mode == PoseMode::kSlam || mode == PoseMode::kPriorMap;
}

}  // namespace

std::string no_pose_text(const pose::PoseConfig& config, const std::vector<bus::Channel>& missing,
                         const std::string& state) {
  std::string text = "yields no pose: pose.mode " + std::string(mode_text(config.mode));
  std::string channels;
  for (const bus::Channel channel : missing) {
    channels += (channels.empty() ? "" : ", ") + std::string(bus::info(channel).name);
  }
  if (!channels.empty()) text += " needs " + channels + ", which the log lacks";
  const bool no_wheels =
      std::find(missing.begin(), missing.end(), bus::Channel::kOdometry) != missing.end();
  if (no_wheels && can_read_scans(config.mode)) {
    text += " (pose.motion: scans estimates the motion from the scans instead)";
  }
  if (!state.empty()) text += "; the pose estimation reports: " + state;
  // With all inputs there, what the estimation reports also says what to do.
  if (channels.empty() && !state.empty()) return text;
  if (channels.empty()) text += ": it has the inputs, but no pose could be computed from them";
  return text +
         "; list the channels of the log with `orchard log info` and set pose.mode accordingly";
}

}  // namespace orchard::cli
