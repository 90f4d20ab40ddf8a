// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/park/park_config.hpp"

namespace orchard::simulation {

/// The way of a car through a park: from the middle to places drawn at random, half of them places
/// where it was before, which it then reaches from another side. It steers as a car does: no
/// tighter than its turning circle, and no faster from lock to lock than a driver turns the wheel.
DrivePath make_park_path(std::uint64_t seed, const ParkConfig& config);

}  // namespace orchard::simulation
