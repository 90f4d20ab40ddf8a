// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "geometry/point_grid.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Field of view of a laser and its extrinsics.
struct SensorView {
  double reach_m = 20.0;  ///< max detection range
  double bearing_min_rad = -3.14159265358979323846;
  double bearing_max_rad = 3.14159265358979323846;
  double mount_x_m = 0.0;  ///< position of the laser in base
  double mount_y_m = 0.0;
  double mount_yaw_rad = 0.0;
  int min_observations = 1;  ///< min number of observations of mapped landmarks
};

/// Time for which each cell of 0.5 m was in view of a drive, per distance bin.
///
/// Computed from poses along the path; landmarks of the drive's own map occlude what is behind
/// them. Each pose counts for its duration, within limits. Two maps are compared at few cells, so
/// only those are computed that are asked for; all of them, for plans, only as weighted sums, since
/// their times would need 170 MB per square kilometre.
class VisibilityGrid {
 public:
  /// derived: half the distance at which coverage changes.
  static constexpr double kCell_m = 0.5;
  /// derived: Upper ends of the distance bins [m]; the last bin extends to the range of the sensor.
  static constexpr std::array<double, 12> kRangeEnds_m{1.5, 2.5, 3.5,  4.5,  5.5,  6.5,
                                                       7.5, 9.0, 11.0, 13.0, 16.0, 1e9};
  using Seconds = std::array<float, kRangeEnds_m.size()>;  ///< time in view per distance bin
  using Weights = std::array<double, kRangeEnds_m.size()>;
  using Index = std::pair<int, int>;  ///< of a cell, or of a group of cells

  /// The cell that contains a point of map.
  static Index cell_of(const Eigen::Vector2d& p_map);

  /// A pose of the drive, with the time that it stands for.
  struct View {
    Eigen::Vector2d p_laser{0.0, 0.0};
    double yaw_rad = 0.0;
    double seconds = 0.0;
  };

  /// `trajectories`: T_map_base in order of utime, one per drive, in the landmarks' frame.
  VisibilityGrid(const std::vector<Landmark>& landmarks,
                 const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                 const SensorView& view);

  /// Times in view of the cells that contain points of map. Costs a look from every pose near them:
  /// ask for many at once.
  std::vector<Seconds> at(const std::vector<Eigen::Vector2d>& points) const;

  /// Computes the sums over the distance bins of time times weight, of all cells.
  void weigh(const Weights& per_second);

  /// The sum of the cell that contains a point of map; 0 before weigh().
  double sum_at(const Eigen::Vector2d& p_map) const;
  /// Calls visit(centre, sum) for all cells of the tiles in view; none before weigh().
  void visit_sums(const std::function<void(const Eigen::Vector2d&, double)>& visit) const;

 private:
  /// derived: a tile is 16 m wide.
  static constexpr int kTileCells = 32;
  /// derived: 256 m wide, so that little is looked at from two blocks at a reach of 20 m; its times
  /// need 13 MB.
  static constexpr int kBlockTiles = 16;
  static constexpr int kBlockCells = kTileCells * kBlockTiles;  ///< derived: of a block
  using Tile = std::vector<float>;  ///< times of all its cells in the first bin, the second ...
  using Block = std::array<Tile, kBlockTiles * kBlockTiles>;

  std::vector<float> free_distance_m(const View& from) const;
  void add_view(const View& from, const Index& block, Block& times) const;

  geometry::IndexedPoints things_;
  std::vector<double> radius_m_;
  std::vector<View> views_;
  SensorView view_;
  std::map<Index, std::vector<double>> sums_;  ///< by tile
};

/// Detection probability of one drive as a function of position.
///
/// Learnt from the drive's own map: observations per second in view of its trees, by distance, and
/// their variation between trees. Range, field of view and high grass therefore need no
/// configuration. No detection at a position that was in view for long is evidence of absence; an
/// occluded position, or one out of range, is no evidence.
class DetectionMap {
 public:
  /// Creates a map of an unknown drive; is_known() is false.
  DetectionMap() = default;
  DetectionMap(const std::vector<Landmark>& landmarks,
               const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
               const SensorView& view);

  bool is_known() const { return is_known_; }

  /// Expected numbers of observations of an average tree at positions; 0 if nothing is known. Costs
  /// a look from every pose near those that are no landmark of this map: ask for many at once.
  std::vector<double> expected_observations(const std::vector<Eigen::Vector2d>& p_map) const;

  /// Repeat rates of landmarks of this map: fraction of opportunities at which each was observed,
  /// in (0, 1]. 1 for well visible trees and if nothing is known.
  std::vector<double> rates(const std::vector<Landmark>& landmarks) const;

  /// Probability that this drive maps an existing object that another drive observed with repeat
  /// rate `rate`, given how often this one is expected to observe a tree there; 1 if nothing is
  /// known.
  double probability_mapped(double expected, double rate) const;

  /// Probabilities that existing landmarks of another map, at `p_map` in this one, are missing from
  /// this map: occluded, out of range, or visible on some visits only. 1 if nothing is known. As
  /// costly as expected_observations().
  std::vector<double> probabilities_missed(const std::vector<Eigen::Vector2d>& p_map,
                                           const DetectionMap& other,
                                           const std::vector<const Landmark*>& of_other) const;

  /// Probability that an average tree is missed at any position, in [0, 1]; 1 if nothing is known.
  /// Computes all of the map: for who asks for more and more positions.
  std::function<double(const Eigen::Vector2d& p_map)> probability_missed_anywhere() const;
  /// Centres of the cells of VisibilityGrid::kCell_m where an average tree would rather be mapped
  /// than missed, in map [m]; none if nothing is known. Costs as much as the function above.
  std::vector<Eigen::Vector2d> places_seen() const;

 private:
  double probability_missed(double expected, double visibility) const;
  double visibility(double expected, const Landmark& landmark) const;
  double rate(double expected, const Landmark& landmark) const;

  bool is_known_ = false;
  std::vector<VisibilityGrid> raster_;    ///< one element, or none
  VisibilityGrid::Weights per_second_{};  ///< observations in view of an average tree
  /// Cells of this map's landmarks with their expected_observations(), in order of the cells.
  std::vector<std::pair<VisibilityGrid::Index, double>> of_landmarks_;
  double clear_visibility_ = 1.0;  ///< of well visible trees, relative to the average tree
  double num_mapped_min_ = 1.0;    ///< min number of observations of mapped landmarks
  double shape_ = 1.0;             ///< shape parameter of the negative binomial
};

}  // namespace orchard::mapping
