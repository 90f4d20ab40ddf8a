// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard import FOLDER|RAWLOG --out LOG`.
struct ImportOptions {
  std::string source_path;  ///< a recording folder (with sensors.yaml) or an MRPT rawlog
  std::string out_path;
};

/// Writes a recording as an LCM log; returns the exit code. Throws io::FileError.
int run_import(const ImportOptions& options);

}  // namespace orchard::cli
