// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/point_grid.hpp"
#include "mapping/existence/free_space.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// What the scans of a drive, and the robot by having been there, saw free.
///
/// Asked where ways may run. The nearest scans with a view of a place vote; a returning beam counts
/// three times a passing one, so that a hedge that lets some through is none.
class SeenGround {
 public:
  /// The evidence of a scan, by its number; none where it has none.
  using FreeSpaceOf = std::function<std::shared_ptr<const FreeSpace>(std::int32_t scan)>;

  explicit SeenGround(FreeSpaceOf free_space_of) : free_space_of_(std::move(free_space_of)) {}

  /// A robot that stands tells nothing new: scans from where the last one was are left out.
  void add_scan(std::int32_t scan, const pose::PoseEstimate& T_map_base);

  /// Whether a place of map, two decimetres wide, was seen free, or driven over.
  bool is_free(const Eigen::Vector2d& p_map);

  /// Whether those scans met something there, and too often for it to be free.
  bool is_blocked(const Eigen::Vector2d& p_map);

  /// Calls visit(scan, beams) for each scan that may have a view of a place, the nearest first,
  /// until it returns false.
  void visit_views(const Eigen::Vector2d& p_map,
                   const std::function<bool(std::int32_t scan, const FreeSpace& beams)>& visit);

 private:
  struct Votes {
    int num_passes = 0, num_returns = 0;
    bool is_driven = false;
    bool is_passable() const;
  };
  Votes votes_at(const Eigen::Vector2d& p_map);
  std::vector<std::pair<double, std::int32_t>> scans_near(const Eigen::Vector2d& p_map) const;

  struct Scan {
    std::int32_t number = 0;
    Eigen::Vector3d x_y_yaw{0, 0, 0};  ///< T_map_base
  };
  const FreeSpace* free_space(std::int32_t number);

  FreeSpaceOf free_space_of_;
  std::vector<Scan> scans_;
  geometry::PointGrid grid_{8.0};
  std::unordered_map<std::int32_t, std::shared_ptr<const FreeSpace>> unpacked_;  ///< some of them
};

}  // namespace orchard::mapping
