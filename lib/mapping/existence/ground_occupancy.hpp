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
#include "mapping/free_space.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// derived: Width of a queried position [m]: two or more beams cross it.
inline constexpr double kSeenPlace_m = 0.2;

/// Free and blocked ground, from the scans of a drive and the robot's path. Used for the navigation
/// graph.
///
/// The nearest scans with a view of a position vote. A returned beam counts three times a passing
/// one, so that a sparse hedge is not free.
class GroundOccupancy {
 public:
  /// Returns the free-space evidence of a scan by its number; null if there is none.
  using FreeSpaceOf = std::function<std::shared_ptr<const FreeSpace>(std::int32_t scan)>;

  explicit GroundOccupancy(FreeSpaceOf free_space_of) : free_space_of_(std::move(free_space_of)) {}

  /// Adds a scan, skipped if the robot has hardly moved since the last one. `has_beams`: whether it
  /// has free-space evidence, not only a place that was driven over.
  void add_scan(std::int32_t scan, const pose::PoseEstimate& T_map_base, bool has_beams = true);

  /// Whether a position in map, 0.2 m wide, was observed free or was driven over.
  bool is_free(const Eigen::Vector2d& p_map);

  /// Evidence at the passage between two positions in map. `half_depth_m`: of the passage, to each
  /// side of the line between them; `clear_m`: how far a beam through it goes on.
  Passage passage(const Eigen::Vector2d& from_map, const Eigen::Vector2d& to_map,
                  double half_depth_m, double clear_m);

  /// Calls visit(scan, beams) for each scan within range of a position, nearest first, until it
  /// returns false.
  void visit_views(const Eigen::Vector2d& p_map,
                   const std::function<bool(std::int32_t scan, const FreeSpace& beams)>& visit);

 private:
  struct Votes {
    int num_passes = 0, num_returns = 0;
    bool is_driven = false;
    bool is_passable() const;
    bool are_decided() const;
  };
  bool is_open(const Eigen::Vector2d& from_map, const Eigen::Vector2d& to_map, double half_depth_m,
               double clear_m);
  Votes votes_at(const Eigen::Vector2d& p_map);

  struct Scan {
    std::int32_t number = 0;
    Eigen::Vector3d x_y_yaw{0, 0, 0};  ///< T_map_base
    bool has_beams = false;
  };
  template <class Visit>
  void visit_near(const Eigen::Vector2d& p_map, const Visit& visit);
  const FreeSpace* free_space(std::int32_t number);

  FreeSpaceOf free_space_of_;
  std::vector<Scan> scans_;
  geometry::PointGrid grid_{4.0};
  std::unordered_map<std::int32_t, std::shared_ptr<const FreeSpace>> unpacked_;  ///< cache
};

}  // namespace orchard::mapping
