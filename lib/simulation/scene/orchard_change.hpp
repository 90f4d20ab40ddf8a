// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/change_config.hpp"
#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Changes an orchard to a later day: trees felled, planted in empty positions, moved, grown. All
/// other objects stay unchanged; truth and targets are renumbered.
void change_orchard(std::uint64_t seed, const ChangeConfig& config, Scene& scene);

}  // namespace orchard::simulation
