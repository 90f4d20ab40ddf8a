// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "geometry/camera_model.hpp"
#include "io/config/config_edit.hpp"

namespace orchard::cli {

/// Input and output files for writing a camera into a rig's YAML.
struct RigTarget {
  std::string config_path;  ///< rig to start from; empty: none
  std::string out_path;     ///< empty: do not write
};

/// Resolves the options: --out is the file to write (default: --config, in place), --config the one
/// to start from (default: --out when it exists). Throws io::ConfigError when that is not a rig's
/// YAML.
RigTarget rig_target(const std::string& config_path, const std::string& out_path);

/// Throws io::FileError when the picture size of the rig to start from differs from the camera's,
/// unless `force`. `what` names the camera in the message.
void check_size(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                const std::string& what, bool force);

/// The lens parameters as values for a rig's YAML.
std::vector<io::ConfigValue> rig_values_of(const geometry::CameraIntrinsics& camera);

/// Writes the lens parameters into the rig, with a note on their source. Throws io::FileError and
/// io::ConfigError, and then leaves every file unchanged.
void write_rig_camera(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                      const std::string& note, bool quiet);

}  // namespace orchard::cli
