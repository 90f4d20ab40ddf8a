// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/pose_composition.hpp"

#include <mrpt/poses/CPose3D.h>

namespace orchard::mapping {

PoseComposition::PoseComposition(const pose::PoseEstimate& pose) : x_m_(pose.x_m), y_m_(pose.y_m) {
  const mrpt::poses::CPose3D T_map_base(pose.x_m, pose.y_m, 0.0, pose.yaw_rad, pose.pitch_rad,
                                        pose.roll_rad);
  const auto& rotation = T_map_base.getRotationMatrix();
  xx_ = rotation(0, 0);
  xy_ = rotation(0, 1);
  yx_ = rotation(1, 0);
  yy_ = rotation(1, 1);
}

}  // namespace orchard::mapping
