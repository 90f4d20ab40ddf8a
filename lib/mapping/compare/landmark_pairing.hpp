// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/point_grid.hpp"
#include "geometry/pose2.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Where landmarks stand, in their order.
std::vector<Eigen::Vector2d> places_of(const std::vector<Landmark>& landmarks);

/// Points with the grid that finds them.
class IndexedPoints {
 public:
  explicit IndexedPoints(std::vector<Eigen::Vector2d> points);

  std::size_t size() const { return points_.size(); }
  const Eigen::Vector2d& operator[](std::size_t i) const { return points_[i]; }
  const std::vector<Eigen::Vector2d>& points() const { return points_; }

  /// The nearest point within `radius_m`, the first of equally near ones; -1 for none.
  std::int32_t nearest(const Eigen::Vector2d& p, double radius_m) const;

  /// All within `radius_m` in order of index.
  std::vector<std::int32_t> within(const Eigen::Vector2d& p, double radius_m) const;

  /// Up to `count` nearest of them within `radius_m`, near ones first.
  std::vector<std::int32_t> nearest_few(const Eigen::Vector2d& p, double radius_m,
                                        std::size_t count) const;

 private:
  std::vector<Eigen::Vector2d> points_;
  geometry::PointGrid grid_;
};

/// The same thing in two maps.
struct LandmarkPair {
  std::int32_t a = 0;
  std::int32_t b = 0;
  Eigen::Vector2d residual_m{0.0, 0.0};  ///< T_a_b p_b - p_a
};

/// Pairs one to one what lies within `gate_m` once b is brought into the frame of a: near pairs
/// first. In rising order of a.
std::vector<LandmarkPair> pair_landmarks(const IndexedPoints& a, const IndexedPoints& b,
                                         const geometry::Pose2& T_a_b, double gate_m);

/// Takes out of each residual what its neighbours have in common: two maps of one drive each are
/// bent a little against each other. Fewer than 12 pairs stay as they are.
void remove_common_residuals(const IndexedPoints& a, std::vector<LandmarkPair>& pairs);

/// Median distance from a point to the nearest other one [m]; 0 for fewer than two points.
double typical_spacing_m(const IndexedPoints& points);

}  // namespace orchard::mapping
