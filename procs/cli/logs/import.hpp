// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard import FOLDER|RAWLOG|LOG --out LOG`.
struct ImportOptions {
  std::string source_path;  ///< a recording folder (with sensors.yaml), an MRPT rawlog, or an LCM
                            ///< log of a robot that speaks libbot's types
  std::string out_path;
  std::string config_path;  ///< a rig whose drivers.bot_core says how an LCM log is read
};

/// Writes a recording as an LCM log; returns the exit code. Throws io::FileError.
int run_import(const ImportOptions& options);

}  // namespace orchard::cli
