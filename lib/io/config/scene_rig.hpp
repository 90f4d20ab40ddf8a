// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "io/config/config.hpp"

namespace orchard::io {

/// The rig that a simulated scene ("tubes", "orchard", "board") is driven with unless another one
/// is given: config/tubes.yaml or config/orchard.yaml as they were when the program was built, so
/// that it is found wherever the program is installed. The defaults for any other name.
Config scene_rig(std::string_view scene);

}  // namespace orchard::io
