// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bus/process/process.hpp"
#include "device/drivers_config.hpp"

namespace orchard::procs {

/// The scanner of a section of the rig's drivers, on SCAN or on SCAN.rear. `plane_height_m`: that
/// of its section laser or laser_rear.
bus::StreamDevice make_laser_device(const device::LaserDriverConfig& config, double plane_height_m,
                                    bus::Channel channel);

}  // namespace orchard::procs
