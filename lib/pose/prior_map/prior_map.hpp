// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "geometry/point_grid.hpp"

namespace orchard::pose {

/// Prior fraction of the trees that is gone, and that is new, between two days.
inline constexpr double kChangeFraction = 0.05;

/// A landmark of an earlier day's map.
struct PriorLandmark {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();  ///< [m]
  double width_m = 0.0;                             ///< 0 = unknown
  double weight = 1.0;                              ///< against its doubles: how often it was seen
  double sd_m = 0.0;  ///< of its position by itself, beyond what all landmarks err by
  double rate = 1.0;  ///< fraction of its chances at which the earlier drive saw it
};

/// What an earlier day left: a map, and where it was looked.
struct EarlierMap {
  EarlierMap() = default;
  EarlierMap(std::vector<PriorLandmark> all) : landmarks(std::move(all)) {}

  std::vector<PriorLandmark> landmarks;
  std::vector<Eigen::Vector2d> path_m;  ///< of its laser, every half metre or so; none: not known
  double reach_m = 0.0;                 ///< of the laser there
};

/// Why no robot can find its place by these landmarks (too few, not in metres, not finite), in
/// words that complete "the prior map ..."; empty if one can.
std::string problem_with(const std::vector<PriorLandmark>& landmarks);

/// The landmarks with those that stand nearer to each other than two trunks can made one: a map may
/// hold a tree twice, once as it was seen from either side.
std::vector<PriorLandmark> without_doubles(const std::vector<PriorLandmark>& landmarks);

/// The landmarks of a prior map, ordered for two questions: what stands near a point, and which
/// pairs stand at a given distance.
class PriorMap {
 public:
  struct Pair {
    float distance_m;
    std::int32_t first, second;  ///< first < second
  };

  PriorMap(EarlierMap earlier, double pair_max_m);

  std::size_t size() const { return landmarks_.size(); }
  const PriorLandmark& operator[](std::int32_t i) const {
    return landmarks_[static_cast<std::size_t>(i)];
  }

  /// Calls visit(index) for everything within `radius_m` of the point and some beyond, in an order
  /// that depends on the map alone.
  template <class Visit>
  void near(const Eigen::Vector2d& p_map, double radius_m, Visit&& visit) const {
    grid_.near(p_map.x(), p_map.y(), radius_m, visit);
  }

  /// Pairs whose distance lies in [least, most]: a range of pairs().
  std::pair<std::size_t, std::size_t> pairs_at(double least_m, double most_m) const;
  const std::vector<Pair>& pairs() const { return pairs_; }

  /// Probability that another visit that looks at a landmark finds it where it stands.
  double repeat(std::int32_t i) const { return repeat_[static_cast<std::size_t>(i)]; }

  /// Whether the earlier drive looked there; true where its path is not known.
  bool was_looked_at(const Eigen::Vector2d& p_map) const;

  /// How near two things are parts of one clump [m].
  double clump_reach_m() const;

  /// Standard deviation of the widths of the landmarks that have one [m].
  double width_sd_m() const { return width_sd_m_; }
  /// Median distance to the nearest landmark [m].
  double spacing_m() const { return spacing_m_; }

 private:
  std::vector<PriorLandmark> landmarks_;
  geometry::PointGrid grid_{1.0};
  std::vector<Pair> pairs_;  ///< by distance
  std::vector<double> repeat_;
  std::vector<Eigen::Vector2d> path_m_;
  geometry::PointGrid path_grid_{2.0};
  double reach_m_ = 0.0;
  double width_sd_m_ = 0.0;
  double spacing_m_ = 0.0;
};

}  // namespace orchard::pose
