// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation/scene/scenes.hpp"

namespace orchard::simulation {

/// A rig like config/tubes.yaml's: a lens with distortion, nothing mounted quite straight.
inline RigConfig test_rig() {
  RigConfig rig;
  rig.laser.mount_x_m = 0.12;
  rig.camera.intrinsics.fc_px = {221.5, 221.9};
  rig.camera.intrinsics.cc_px = {161.3, 118.2};
  rig.camera.intrinsics.kc = {-0.105, 0.018, 0.0006, -0.0004, 0.0};
  rig.camera.extrinsics.delta_m = {0.004, -0.060, -0.012};
  rig.camera.extrinsics.phi_rad = {1.5788, 0.0065, 1.5628};
  return rig;
}

}  // namespace orchard::simulation
