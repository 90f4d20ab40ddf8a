// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "io/config/config_edit.hpp"
#include "vision/appearance_config.hpp"

namespace orchard::cli {

/// The YAML values that make a rig use a learnt appearance model: colour_model and all of
/// detector.appearance. Numbers are rounded to six digits, which changes no confidence by more than
/// 1e-4.
std::vector<io::ConfigValue> appearance_values(const vision::AppearanceConfig& config);

}  // namespace orchard::cli
