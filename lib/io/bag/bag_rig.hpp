// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/camera_model.hpp"
#include "io/config/config_edit.hpp"
#include "ros/frame_tree.hpp"

namespace orchard::io {

/// The frames of a robot's sensors, as their messages name them; empty: no such sensor.
struct BagFrames {
  std::string base, scan, scan_rear, image, gnss;
};

/// What a bag tells about its rig.
struct BagRig {
  std::vector<ConfigValue> values;  ///< keys of a rig's YAML
  std::vector<std::string> notes;   ///< what it does not tell, and why
};

/// Finds where the sensors sit on base: `laser.mount_*`, `camera.delta_m` and `phi_rad`,
/// `pose.gnss.antenna_m`, and the lens. An upside-down or steeply tilted scanner, and an image
/// whose frame is not an optical one (REP 103), are noted and left out.
BagRig bag_rig(const ros::FrameTree& tree, const BagFrames& frames,
               const std::optional<geometry::CameraIntrinsics>& lens);

}  // namespace orchard::io
