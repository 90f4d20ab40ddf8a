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

/// Raster for scoring a submap's pose: a point scores positive in cells with returns, negative in
/// cells that beams passed through, and zero in unknown cells.
///
/// Coarser levels, at the same spacing, hold the maximum over larger and larger squares; they give
/// the upper bounds by which branch and bound discards whole regions (after Hess et al. 2016).
class OccupancyPyramid {
 public:
  // derived: hundredths; a beam that passes weighs less than a return, which may be of a leaf.
  static constexpr int kHit = 100;      ///< value of a cell with a return
  static constexpr int kThrough = -60;  ///< value of a cell that beams passed through
  static constexpr int kLevels = 6;     ///< squares of 1 to 32 cells

  /// `kernel_m`: repeatability of a return's position, 1-sigma.
  OccupancyPyramid(const Eigen::Vector2d& centre_map, double half_side_m, double cell_m,
                   double kernel_m);

  /// Adds a beam from the laser to its return at `hit_map`.
  void add(const Eigen::Vector2d& laser_map, const Eigen::Vector2d& hit_map);

  /// Computes the values and the coarser levels; call after the last beam.
  void finish();

  double cell_m() const { return cell_m_; }
  int column(double x_map_m) const;
  int row(double y_map_m) const;

  /// Returns the max value in the square of side 2^level cells that starts at this cell; 0 outside
  /// the raster.
  int best(int level, int column, int row) const {
    if (column < 0 || row < 0 || column >= side_ || row >= side_)
      return outside(level, column, row);
    return levels_[level][static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) +
                          static_cast<std::size_t>(column)];
  }

 private:
  /// A square that starts outside may reach into the raster: its bound is kHit.
  int outside(int level, int column, int row) const {
    const int reach = 1 << level;
    return column > -reach && row > -reach && column < side_ && row < side_ ? kHit : 0;
  }

  double cell_m_;
  double kernel_m_;
  int side_;
  Eigen::Vector2d corner_map_;
  std::vector<std::uint8_t> passed_;
  std::vector<std::vector<std::int8_t>> levels_;
};

/// Search window for the pose of a submap.
struct PoseSearchWindow {
  Eigen::Vector3d T_map_submap = Eigen::Vector3d::Zero();  ///< centre of the window
  double half_side_m = 1.0;
  double half_turn_rad = 0.1;
};

/// Result of the search.
struct PoseSearchResult {
  bool found = false;      ///< false: no pose fits, or the limit of work was reached
  bool ambiguous = false;  ///< a different pose fits about as well
  Eigen::Vector3d T_map_submap = Eigen::Vector3d::Zero();
  double score = 0.0;     ///< sum of the raster's values over the points, / kHit
  double on_known = 0.0;  ///< number of points in known cells
  std::int64_t num_operations = 0;
};

/// Finds the pose in the window at which a submap's points fit the raster best, by branch and bound
/// (correlative matching: Olson 2009; bounds: Hess et al. 2016).
///
/// The result is ambiguous if a pose farther away than `same_m`, or rotated by more than
/// `same_rad`, reaches (1 - lead) of the best score. A pure function with bounded work.
PoseSearchResult find_submap_pose(const std::vector<Eigen::Vector2d>& points,
                                  const OccupancyPyramid& raster, const PoseSearchWindow& window,
                                  double same_m, double same_rad, double lead);

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

  const LoopCounts& counts() const { return counts_; }

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
  LoopCounts counts_;
};

}  // namespace orchard::pose
