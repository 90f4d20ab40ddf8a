// SPDX-License-Identifier: BSD-3-Clause
#include "pose/submap/keyframe_scans.hpp"

#include <algorithm>
#include <utility>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

/// Side of the squares in which one return is kept [m].
constexpr double kThinning_m = 0.10;

}  // namespace

KeyframeScans::KeyframeScans(std::shared_ptr<ChunkAllocator> memory)
    : memory_(std::make_unique<RecordStore<Packed>>(
          memory ? std::move(memory) : std::make_shared<HeapChunkAllocator>())) {}

const KeyframeScans::Scan* KeyframeScans::find(int keyframe) const {
  const auto scan =
      std::lower_bound(scans_.begin(), scans_.end(), keyframe,
                       [](const Scan& one, int other) { return one.keyframe < other; });
  return scan != scans_.end() && scan->keyframe == keyframe ? &*scan : nullptr;
}

void KeyframeScans::keep(int keyframe, const std::vector<SurfacePoint>& points) {
  std::vector<Packed> packed;
  for (const SurfacePoint& point : thinned(points, kThinning_m)) {
    const Eigen::Vector2f p = point.p.cast<float>();
    const Eigen::Vector2f n = point.flat ? Eigen::Vector2f(point.normal.cast<float>())
                                         : Eigen::Vector2f(Eigen::Vector2f::Zero());
    packed.push_back({p.x(), p.y(), n.x(), n.y()});
  }
  const auto num_points = static_cast<std::uint32_t>(packed.size());
  Scan scan{keyframe, num_points, memory_->keep(packed), nullptr};
  if (scan.place.first == nullptr) scan.large = large_.emplace_back(std::move(packed)).data();
  scans_.push_back(scan);
}

std::vector<SurfacePoint> KeyframeScans::points(int keyframe,
                                                const Eigen::Vector3d& T_frame_base) const {
  std::vector<SurfacePoint> points;
  const Scan* scan = find(keyframe);
  if (scan == nullptr) return points;
  const Eigen::Matrix2d R = geometry::rotation(T_frame_base.z());
  points.reserve(scan->num_points);
  if (scan->large == nullptr) memory_->use(scan->place);
  const Packed* const all = scan->large != nullptr ? scan->large : scan->place.first;
  for (std::uint32_t i = 0; i < scan->num_points; ++i) {
    const Packed& packed = all[i];
    SurfacePoint point;
    point.p = R * Eigen::Vector2d(packed.x_m, packed.y_m) + T_frame_base.head<2>();
    point.normal = R * Eigen::Vector2d(packed.normal_x, packed.normal_y);
    point.flat = packed.normal_x != 0.0f || packed.normal_y != 0.0f;
    points.push_back(point);
  }
  return points;
}

std::vector<int> KeyframeScans::between(int first, int end) const {
  std::vector<int> keyframes;
  for (const Scan& scan : scans_) {
    if (scan.keyframe >= first && scan.keyframe < end) keyframes.push_back(scan.keyframe);
  }
  return keyframes;
}

}  // namespace orchard::pose
