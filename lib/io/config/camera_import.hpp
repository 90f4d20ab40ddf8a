// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "geometry/camera_model.hpp"
#include "io/config/config_edit.hpp"

namespace orchard::io {

/// A camera calibration read from another tool's file.
struct ImportedCamera {
  std::string kind;  ///< kind of file, for the user: "a ROS camera_info YAML"
  geometry::CameraIntrinsics intrinsics;
};

/// Reads a ROS camera_info YAML (plumb_bob), or an OpenCV FileStorage YAML (camera_matrix,
/// distortion_coefficients, image_width, image_height).
///
/// Throws FileError with one sentence for a file that is over 1 MB, of another kind, incomplete, or
/// describes a lens that k1 k2 p1 p2 k3 cannot model (fisheye, rational polynomial).
ImportedCamera read_camera_file(const std::string& path);

/// The lens parameters as values for a rig's YAML.
std::vector<ConfigValue> camera_values(const geometry::CameraIntrinsics& camera);

}  // namespace orchard::io
