// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace orchard::calibration {

/// OpenCV's number of an ArUco dictionary by its name, such as "4x4_50"; none for an unknown name.
std::optional<int> marker_dictionary(const std::string& name);

/// Number of markers in the dictionary of this name; 0 for an unknown name.
int marker_count(const std::string& name);

}  // namespace orchard::calibration
