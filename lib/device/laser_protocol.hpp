// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "device/drivers_config.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// Makes the protocol object for a scanner. A new protocol is one more line in the source.
/// `plane_height_m`: where layers are joined, above the ground; 0: where trunks are measured.
std::unique_ptr<Protocol> make_laser_protocol(const LaserDriverConfig& config,
                                              double plane_height_m = 0.0);

}  // namespace orchard::device
