// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard import FOLDER|RAWLOG|BAG...|LOG --out LOG`.
struct ImportOptions {
  /// A recording folder (with sensors.yaml), an MRPT rawlog, an LCM log of a robot that speaks
  /// libbot's types, or bags of ROS (files, or rosbag2's folders), which may be several.
  std::vector<std::string> source_paths;
  std::string out_path;
  std::string config_path;          ///< a rig whose drivers.bot_core says how an LCM log is read
  std::vector<std::string> topics;  ///< KIND=TOPIC, of bags
  double slice_height_m = 0.0;      ///< of clouds, above the scanner
  double slice_thickness_m = 0.3;
};

/// Writes a recording as an LCM log; returns the exit code. Throws io::FileError.
int run_import(const ImportOptions& options);

}  // namespace orchard::cli
