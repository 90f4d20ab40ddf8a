// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// The folder of this program and its companion programs. Throws io::FileError.
std::string program_folder();

}  // namespace orchard::cli
