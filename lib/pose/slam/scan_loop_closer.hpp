// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "laser/laser_config.hpp"
#include "pose/graph/record_store.hpp"
#include "pose/pose_config.hpp"
#include "pose/scan_matching/point_map.hpp"
#include "pose/slam/slam_map.hpp"

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

/// Closes loops by scans if the trunks do not constrain the pose: registers the scans of the last
/// part of the path to those taken there long before, and adds the relative pose to the graph.
class ScanLoopCloser {
 public:
  /// `memory` stores the scans; null: the heap.
  ScanLoopCloser(const ScanMotionConfig& config, const laser::LaserConfig& mount,
                 std::shared_ptr<ChunkAllocator> memory = nullptr);

  /// Stores the returns [m, base] of the newest keyframe's scan.
  void keep(const std::vector<SurfacePoint>& points, const SlamMap& map);

  /// Searches for a closure at the newest keyframe if its covariance requires one, within that
  /// covariance. Returns true if a factor was added to the graph.
  bool observe(SlamMap& map);

  /// Drops the closures that the finished graph contradicts; returns true if there were any.
  bool drop_contradicted(SlamMap& map);

  bool is_ambiguous() const { return ambiguous_; }
  int num_searches() const { return num_searches_; }
  int num_closures() const { return num_closures_; }
  int num_refuted() const { return num_refuted_; }
  std::int64_t num_operations() const { return num_operations_; }

 private:
  std::optional<RelativePose> find(const SlamMap& map);
  std::optional<RelativePose> verified(const SlamMap& map, const Eigen::Vector3d& T_map_base,
                                       const std::vector<int>& recent, const std::vector<int>& old);
  int best_supporting_keyframe(const SlamMap& map, const Eigen::Vector3d& T_map_base,
                               const std::vector<SurfacePoint>& points,
                               const std::vector<int>& old);
  void refill(const SlamMap& map, const std::vector<int>& keyframes);

  ScanMotionConfig config_;
  laser::LaserConfig mount_;
  KeyframeScans scans_;
  PointMap points_;
  double filling_ = 0.0;      ///< generation of points_; older points are hidden
  double asked_m_ = 0.0;      ///< travel at the last search
  int solved_keyframes_ = 0;  ///< number of keyframes when the graph was last solved for a closure
  bool ambiguous_ = false;
  int num_searches_ = 0;
  int num_closures_ = 0;
  int num_refuted_ = 0;
  std::int64_t num_operations_ = 0;
};

}  // namespace orchard::pose
