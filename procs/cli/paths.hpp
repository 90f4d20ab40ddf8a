// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// Makes the parent folder of a file if it is missing. Does nothing for an empty path. Throws
/// io::FileError.
void make_parent_folder(const std::string& file_path);

}  // namespace orchard::cli
