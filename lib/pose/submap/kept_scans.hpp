// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "pose/graph/row_memory.hpp"
#include "pose/scan_matching/surface_points.hpp"

namespace orchard::pose {

/// The scans that keyframes were made at, thinned and packed: sixteen bytes a point, six kilobytes
/// a metre of path, of which a closure needs a few stretches. They lie in chunks.
class KeptScans {
 public:
  /// `memory` holds the points; none: the heap.
  explicit KeptScans(std::shared_ptr<ChunkMemory> memory = nullptr);

  /// Keeps the returns [m, base] of the scan taken at a keyframe, later than all before.
  void keep(int keyframe, const std::vector<SurfacePoint>& points);

  /// Whether a keyframe has a scan.
  bool has(int keyframe) const { return find(keyframe) != nullptr; }

  /// The returns of a keyframe's scan, moved by T_frame_base; none if it has no scan.
  std::vector<SurfacePoint> points(int keyframe, const Eigen::Vector3d& T_frame_base) const;

  /// Keyframes that have a scan, ascending, from `first` to before `end`.
  std::vector<int> between(int first, int end) const;

  /// None of them is needed for the moment.
  void rest() const { memory_->rest(); }

 private:
  struct Packed {
    float x_m, y_m, normal_x, normal_y;  ///< normal 0: not flat
  };
  struct Scan {
    int keyframe = 0;
    std::uint32_t num_points = 0;
    const Packed* points = nullptr;
  };
  const Scan* find(int keyframe) const;

  std::unique_ptr<RowMemory<Packed>> memory_;
  std::vector<Scan> scans_;                ///< ascending
  std::deque<std::vector<Packed>> large_;  ///< scans of more points than fit into a chunk
};

}  // namespace orchard::pose
