// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard export MAP --format WORD --out FILE`.
struct ExportOptions {
  std::string map_path;
  std::string format;
  std::string out_path;
  std::string layer;  ///< empty: all layers that the format supports
  bool as_mapped = false;
  bool overwrite = false;
  bool json = false;
};

/// Exports a map with its manual corrections to another format; returns the exit code. Throws
/// io::FileError.
int run_export(const ExportOptions& options);

}  // namespace orchard::cli
