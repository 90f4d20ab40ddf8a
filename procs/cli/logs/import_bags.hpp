// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/logs/import.hpp"

namespace orchard::cli {

/// Converts the bags of one drive to an LCM log; returns the exit code. Throws io::FileError.
int import_bags(const ImportOptions& options);

}  // namespace orchard::cli
