// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// Makes the folder that a file is to be written into, when it is missing. Does nothing for an
/// empty path. Throws io::FileError.
void make_parent_folder(const std::string& file_path);

}  // namespace orchard::cli
