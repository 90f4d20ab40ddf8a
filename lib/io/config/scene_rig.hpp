// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "io/config/config.hpp"

namespace orchard::io {

/// Default rig of a simulated scene ("tubes", "orchard", "park", "board"): tubes.yaml, orchard.yaml
/// or park.yaml of config/ as of the build, so that it is available wherever the program is
/// installed. Returns the built-in defaults for any other name.
Config scene_rig(std::string_view scene);

}  // namespace orchard::io
