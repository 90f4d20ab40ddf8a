// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard export MAP --format WORD --out FILE`.
struct ExportOptions {
  std::string map_path;
  std::string format;
  std::string out_path;
  std::string layer;  ///< empty: all that the format can hold
  bool as_mapped = false;
  bool overwrite = false;
  bool json = false;
};

/// Writes a map, as corrected by hand, for another program; returns the exit code. Throws
/// io::FileError.
int run_export(const ExportOptions& options);

}  // namespace orchard::cli
