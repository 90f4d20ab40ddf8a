// SPDX-License-Identifier: BSD-3-Clause
#include <utility>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapper/mapper_node.hpp"

namespace orchard::procs {
namespace {

/// Interval over which the velocity of base is estimated from its poses.
constexpr std::int64_t kMotion_us = 200'000;

constexpr double kMotion_s = 1e-6 * static_cast<double>(kMotion_us);

}  // namespace

void MapperNode::photograph(const detection::Detections& detections,
                            const pose::PoseEstimate& T_map_base) {
  if (!album_.is_open() || detections.image_utime == 0) return;
  std::vector<mapping::Subject> subjects;
  for (const detection::Detection& d : detections.trunks) {
    subjects.push_back({d.centre_x_m, d.centre_y_m, d.width_m, d.occlusion});
  }
  // Use past poses only: the later poses available here depend on the order of arrival.
  detection::Motion motion;
  const auto before = track_.at(detections.utime - kMotion_us);
  if (before && deskews(detections)) {
    const geometry::Pose2 way =
        between(geometry::Pose2{before->x_m, before->y_m, before->yaw_rad},
                geometry::Pose2{T_map_base.x_m, T_map_base.y_m, T_map_base.yaw_rad});
    motion.speed_mps = way.x_m / kMotion_s;
    motion.yaw_rate_radps = way.yaw_rad / kMotion_s;
  }
  album_.add_scan(detections.utime, detections.image_utime, T_map_base, motion,
                  std::move(subjects));
}

}  // namespace orchard::procs
