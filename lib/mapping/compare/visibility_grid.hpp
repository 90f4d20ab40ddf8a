// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Where a laser looks, as it is mounted on its robot.
struct SensorView {
  double reach_m = 20.0;  ///< farther things are never detected
  double bearing_min_rad = -3.14159265358979323846;
  double bearing_max_rad = 3.14159265358979323846;
  double mount_x_m = 0.0;  ///< of the laser in base
  double mount_y_m = 0.0;
  double mount_yaw_rad = 0.0;
};

/// For how long a drive looked at each place, by distance: cells of half a metre.
///
/// Looks from poses along the path; what the landmarks of the drive's own map hide is not looked
/// at. Time counts where the robot was slow, within reason.
class LookRaster {
 public:
  static constexpr double kCell_m = 0.5;
  /// Far ends of the distances that are told apart [m]; the last one is the reach.
  static constexpr std::array<double, 12> kRangeEnds_m{1.5, 2.5, 3.5,  4.5,  5.5,  6.5,
                                                       7.5, 9.0, 11.0, 13.0, 16.0, 1e9};
  using Looks = std::array<float, kRangeEnds_m.size()>;  ///< seconds by distance

  /// `trajectories`: T_map_base in order of utime, one per drive, in the landmarks' frame.
  LookRaster(const std::vector<Landmark>& landmarks,
             const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
             const SensorView& view);

  /// Looks at the cell that holds a point of map.
  Looks at(const Eigen::Vector2d& p_map) const;

 private:
  static constexpr int kTileCells = 32;
  using Tile = std::vector<Looks>;

  /// Rounds towards minus infinity.
  static int tile_of(int cell);
  void add_view(const Eigen::Vector2d& p_laser, double reach_m, float seconds,
                const std::vector<float>& free_m);

  std::map<std::pair<int, int>, Tile> tiles_;
};

}  // namespace orchard::mapping
