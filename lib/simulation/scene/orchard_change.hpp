// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/change_config.hpp"
#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Makes a later day of an orchard: trees felled, planted in empty places, moved, grown. All that
/// is not chosen stays where and as it was; truth and targets are numbered anew.
void change_orchard(std::uint64_t seed, const ChangeConfig& config, Scene& scene);

}  // namespace orchard::simulation
