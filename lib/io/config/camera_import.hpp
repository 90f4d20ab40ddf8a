// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/camera_model.hpp"

namespace orchard::io {

/// A camera as another tool's file describes it.
struct ImportedCamera {
  std::string kind;  ///< of file, for people: "Bouguet's Calib_Results.m"
  geometry::CameraIntrinsics intrinsics;
  std::optional<std::array<double, 2>> fc_sd_px;  ///< standard deviations, where the file has them
  std::optional<std::array<double, 2>> cc_sd_px;
};

/// Reads Bouguet's Calib_Results.m, a ROS camera_info YAML (plumb_bob), or an OpenCV FileStorage
/// YAML (camera_matrix, distortion_coefficients, image_width, image_height).
///
/// Throws FileError in one sentence for a file over 1 MB, one that is none of these, lacks a part,
/// or describes a lens that k1 k2 p1 p2 k3 cannot (fisheye, rational polynomial).
ImportedCamera read_camera_file(const std::string& path);

/// The same from text; `name` stands for the file in messages.
ImportedCamera parse_camera_matlab(std::string_view text, const std::string& name);
ImportedCamera parse_camera_yaml(std::string_view text, const std::string& name);

}  // namespace orchard::io
