// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::io {

/// Makes a folder, and those above it, unless they are there already. Throws FileError, which ends
/// with what to do instead where `advice` says it.
void make_folder(const std::string& folder, const std::string& advice = {});

}  // namespace orchard::io
