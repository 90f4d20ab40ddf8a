// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "pose/pose_config.hpp"

namespace orchard::cli {

/// Why a drive gave no pose at all, in words that complete "LOG ...": the mode, the inputs of it
/// that are missing, and the keys to set. `missing`: channels that the mode needs and did not get;
/// `state`: what the mode says itself, or nothing.
std::string no_pose_text(const pose::PoseConfig& config, const std::vector<bus::Channel>& missing,
                         const std::string& state);

}  // namespace orchard::cli
