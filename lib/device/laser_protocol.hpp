// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "device/drivers_config.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// The talk with a scanner of a make. Another make is one more line here.
std::unique_ptr<Protocol> make_laser_protocol(LaserProtocol protocol);

}  // namespace orchard::device
