// SPDX-License-Identifier: BSD-3-Clause
#include "pose/submap/kept_scans.hpp"

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

/// Side of the squares in which one return is kept [m].
constexpr double kThinning_m = 0.10;

}  // namespace

void KeptScans::keep(int keyframe, const std::vector<SurfacePoint>& points) {
  std::vector<Packed>& packed = scans_[keyframe];
  packed.clear();
  for (const SurfacePoint& point : thinned(points, kThinning_m)) {
    const Eigen::Vector2f p = point.p.cast<float>();
    const Eigen::Vector2f n = point.flat ? Eigen::Vector2f(point.normal.cast<float>())
                                         : Eigen::Vector2f(Eigen::Vector2f::Zero());
    packed.push_back({p.x(), p.y(), n.x(), n.y()});
  }
  packed.shrink_to_fit();
}

std::vector<SurfacePoint> KeptScans::points(int keyframe,
                                            const Eigen::Vector3d& T_frame_base) const {
  std::vector<SurfacePoint> points;
  const auto scan = scans_.find(keyframe);
  if (scan == scans_.end()) return points;
  const Eigen::Matrix2d R = geometry::rotation(T_frame_base.z());
  points.reserve(scan->second.size());
  for (const Packed& packed : scan->second) {
    SurfacePoint point;
    point.p = R * Eigen::Vector2d(packed.x_m, packed.y_m) + T_frame_base.head<2>();
    point.normal = R * Eigen::Vector2d(packed.normal_x, packed.normal_y);
    point.flat = packed.normal_x != 0.0f || packed.normal_y != 0.0f;
    points.push_back(point);
  }
  return points;
}

std::vector<int> KeptScans::between(int first, int end) const {
  std::vector<int> keyframes;
  for (auto scan = scans_.lower_bound(first); scan != scans_.end() && scan->first < end; ++scan) {
    keyframes.push_back(scan->first);
  }
  return keyframes;
}

}  // namespace orchard::pose
