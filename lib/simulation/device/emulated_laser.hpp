// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "device/drivers_config.hpp"
#include "simulation/device/emulated_device.hpp"

namespace orchard::simulation {

/// An emulated scanner that speaks `protocol` and was switched on at `start_utime`; its angles,
/// ranges and rate are those of the first scans that it is given.
std::unique_ptr<EmulatedDevice> make_emulated_laser(device::LaserProtocol protocol,
                                                    std::int64_t start_utime);

}  // namespace orchard::simulation
