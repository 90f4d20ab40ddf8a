// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "device/drivers_config.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// Makes the protocol object for a scanner. A new protocol is one more line in the source.
std::unique_ptr<Protocol> make_laser_protocol(const LaserDriverConfig& config);

}  // namespace orchard::device
