// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// Where this program lies, and those that belong beside it. Throws io::FileError.
std::string program_folder();

}  // namespace orchard::cli
