// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard import FOLDER|RAWLOG|BAG...|LOG --out LOG`.
struct ImportOptions {
  /// A recording folder (with sensors.yaml), an MRPT rawlog, an LCM log of a robot with libbot's
  /// types, or one or more ROS bags (files, or folders of rosbag2).
  std::vector<std::string> source_paths;
  std::string out_path;
  std::string config_path;          ///< rig whose drivers.bot_core tells how to read an LCM log
  std::vector<std::string> topics;  ///< KIND=TOPIC, for bags
  double slice_height_m = 0.0;      ///< for clouds, above the scanner
  double slice_thickness_m = 0.3;
};

/// Converts a recording to an LCM log; returns the exit code. Throws io::FileError.
int run_import(const ImportOptions& options);

}  // namespace orchard::cli
