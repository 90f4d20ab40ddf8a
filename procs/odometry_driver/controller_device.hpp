// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bus/process/process.hpp"
#include "device/drivers_config.hpp"

namespace orchard::procs {

/// A device that sends text lines, at `address`; `channel`: the channel played when a log replaces
/// the device.
bus::StreamDevice make_controller_device(const device::DriversConfig& drivers,
                                         const std::string& address, bus::Channel channel);

}  // namespace orchard::procs
