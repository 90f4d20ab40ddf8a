// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace orchard::calibration {

/// OpenCV's number of a dictionary of ArUco markers, named as "4x4_50"; none for another name.
std::optional<int> marker_dictionary(const std::string& name);

/// How many markers a dictionary of that name holds; 0 for another name.
int marker_count(const std::string& name);

}  // namespace orchard::calibration
