// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::io {

/// Creates a folder and its parents if they are missing. Throws FileError; `advice`, if given, is
/// the remedy at the end of the message.
void make_folder(const std::string& folder, const std::string& advice = {});

}  // namespace orchard::io
