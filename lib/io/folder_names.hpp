// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::io {

/// Lists the names in a folder, sorted; empty if it cannot be read.
std::vector<std::string> folder_names(const std::string& folder);

}  // namespace orchard::io
