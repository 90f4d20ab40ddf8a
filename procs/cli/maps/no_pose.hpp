// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "pose/pose_config.hpp"

namespace orchard::cli {

/// The reason why a drive gave no pose at all, as text that completes "LOG ...": the mode, its
/// missing inputs, and the keys to set. `missing`: required channels without messages; `state`: the
/// mode's own message, or empty.
std::string no_pose_text(const pose::PoseConfig& config, const std::vector<bus::Channel>& missing,
                         const std::string& state);

}  // namespace orchard::cli
