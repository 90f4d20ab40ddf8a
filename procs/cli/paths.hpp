// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// Makes the parent folder of a file if it is missing. Does nothing for an empty path. Throws
/// io::FileError.
void make_parent_folder(const std::string& file_path);

/// Does not overwrite a file unless requested: throws io::FileError if it is there.
void require_free(const std::string& file_path, bool overwrite);

}  // namespace orchard::cli
