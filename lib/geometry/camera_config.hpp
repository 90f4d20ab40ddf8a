// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/camera_model.hpp"
#include "geometry/laser_camera.hpp"

namespace orchard::geometry {

/// The camera of a rig: intrinsics, extrinsics, delay. Section `camera`.
struct CameraConfig {
  bool enabled = true;
  /// Fixed delay of the camera: the exposure is this much earlier than the picture's utime.
  double delay_s = 0.0;
  CameraIntrinsics intrinsics;
  LaserCameraExtrinsics extrinsics{{0.0, -0.06, 0.0},
                                   {1.5707963267948966, 0.0, 1.5707963267948966}};
};

template <class Visitor>
void describe(Visitor& v, CameraConfig& c) {
  v.flag("enabled", c.enabled, "false for a rig without a camera: detection by the laser only");
  v.number("delay_s", c.delay_s, -0.5, 0.5, "s",
           "time from the exposure of a picture to its utime; from `orchard calibrate delay`");
  v.integer("width_px", c.intrinsics.width_px, 16, 8192, "px", "width of the pictures");
  v.integer("height_px", c.intrinsics.height_px, 16, 8192, "px", "height of the pictures");
  v.numbers("fc_px", c.intrinsics.fc_px, 1, 1e5, "px",
            "focal lengths x, y; from `orchard calibrate camera`");
  v.numbers("cc_px", c.intrinsics.cc_px, -1e4, 1e4, "px",
            "principal point x, y; from `orchard calibrate camera`");
  v.expert().number("alpha_c", c.intrinsics.alpha_c, -1, 1, "1",
                    "skew; from `orchard calibrate camera`");
  v.numbers("kc", c.intrinsics.kc, -100, 100, "1",
            "distortion k1, k2, p1, p2, k3; from `orchard calibrate camera`");
  v.numbers("delta_m", c.extrinsics.delta_m, -10, 10, "m",
            "origin of the laser in the camera frame; from `orchard calibrate laser-camera`");
  v.numbers("phi_rad", c.extrinsics.phi_rad, -6.2832, 6.2832, "rad",
            "rotation of the laser to the camera about x, y, z (paper, eq. 2); from `orchard "
            "calibrate laser-camera`");
}

}  // namespace orchard::geometry
