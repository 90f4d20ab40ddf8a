// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "geometry/camera_model.hpp"
#include "io/config/config_edit.hpp"

namespace orchard::cli {

/// Which rig's YAML a camera is written into.
struct RigTarget {
  std::string config_path;  ///< to start from; empty: from nothing
  std::string out_path;     ///< empty: nothing is written
};

/// --out is the file to write (default: --config, in place); --config the one to start from
/// (default: --out when it exists). Throws io::ConfigError when that is no rig's YAML.
RigTarget rig_target(const std::string& config_path, const std::string& out_path);

/// Throws io::FileError when the rig to start from has pictures of another size than the camera
/// has, unless `force`. `what` names the camera's side in the sentence.
void check_size(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                const std::string& what, bool force);

/// The keys of a rig's YAML that describe the lens.
std::vector<io::ConfigValue> rig_values_of(const geometry::CameraIntrinsics& camera);

/// Writes the lens with a note that says where it comes from. Throws io::FileError and
/// io::ConfigError, and then leaves every file as it was.
void write_rig_camera(const RigTarget& target, const geometry::CameraIntrinsics& camera,
                      const std::string& note, bool quiet);

}  // namespace orchard::cli
