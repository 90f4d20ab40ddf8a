// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "device/drivers_config.hpp"
#include "device/emulated/emulated_device.hpp"

namespace orchard::device {

/// Makes an emulated scanner with `protocol`, powered up at `start_utime`. It takes its angles,
/// ranges and rate from the first scans that it is given.
std::unique_ptr<EmulatedDevice> make_emulated_laser(device::LaserProtocol protocol,
                                                    std::int64_t start_utime);

}  // namespace orchard::device
