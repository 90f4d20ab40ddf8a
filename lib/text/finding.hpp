// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard {

/// What a drive or its map contradicts, or makes doubtful.
struct Finding {
  std::string name;  ///< for programs, such as laser_yaw
  std::string key;   ///< of the configuration, or the channel whose driver is wrong; may be empty
  std::string text;  ///< for people: what is wrong, and what to do or the value that would fit
};

}  // namespace orchard
