// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// The names of what lies in a folder, sorted; none where it cannot be read.
std::vector<std::string> folder_names(const std::string& folder);

}  // namespace orchard::io
