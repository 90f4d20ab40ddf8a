// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "pose/graph/record_store.hpp"
#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// Storage of the keyframes' scans, thinned and packed to sixteen bytes per point (about 6 kB per
/// metre of path). The points are stored in chunks, because a closure reads only a few scans.
class KeyframeScans {
 public:
  /// `memory` stores the points; null: the heap.
  explicit KeyframeScans(std::shared_ptr<ChunkAllocator> memory = nullptr);

  /// Stores the returns [m, base] of the scan of a keyframe, which must be later than all before.
  void keep(int keyframe, const std::vector<SurfacePoint>& points);

  /// Returns true if the keyframe has a scan.
  bool has(int keyframe) const { return find(keyframe) != nullptr; }

  /// Returns a keyframe's scan transformed by T_frame_base; empty if it has none.
  std::vector<SurfacePoint> points(int keyframe, const Eigen::Vector3d& T_frame_base) const;

  /// Returns the keyframes in [first, end) that have a scan, ascending.
  std::vector<int> between(int first, int end) const;

 private:
  struct Packed {
    float x_m, y_m, normal_x, normal_y;  ///< normal 0: not flat
  };
  struct Scan {
    int keyframe = 0;
    std::uint32_t num_points = 0;
    RecordStore<Packed>::Place place;
    const Packed* large = nullptr;  ///< points of a scan that does not fit into a chunk
  };
  const Scan* find(int keyframe) const;

  std::unique_ptr<RecordStore<Packed>> memory_;
  std::vector<Scan> scans_;                ///< ascending by keyframe
  std::deque<std::vector<Packed>> large_;  ///< scans of more points than fit into a chunk
};

}  // namespace orchard::pose
