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

/// Prior fraction of trees removed, and of trees added, between two days. physical: growers replace
/// a few of a hundred in a year.
inline constexpr double kChangeFraction = 0.05;

/// A landmark of the prior map.
struct PriorLandmark {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();  ///< [m]
  double width_m = 0.0;                             ///< 0 = unknown
  double weight = 1.0;  ///< number of observations; weight when duplicates are merged
  double sd_m = 0.0;    ///< of its position, in addition to the error common to all landmarks
  double rate = 1.0;    ///< detection rate on the earlier drive
};

/// Map of an earlier day, with where its drive looked.
struct PriorMapData {
  PriorMapData() = default;
  PriorMapData(std::vector<PriorLandmark> all) : landmarks(std::move(all)) {}

  std::vector<PriorLandmark> landmarks;
  /// Centres of the cells in which that drive would have mapped a tree; empty: unknown.
  std::vector<Eigen::Vector2d> seen_m;
  double cell_m = 1.0;  ///< width of these cells
};

/// Checks whether the landmarks are suitable for localisation. Returns the problem (too few, not in
/// metres, not finite) in words that complete "the prior map ..."; empty if there is none.
std::string problem_with(const std::vector<PriorLandmark>& landmarks);

/// Merges landmarks that are nearer to each other than two trunks can be: a map may contain a tree
/// twice, once from either side.
std::vector<PriorLandmark> without_duplicates(const std::vector<PriorLandmark>& landmarks);

/// Index of the landmarks of a prior map for two queries: landmarks near a point, and pairs of
/// landmarks at a given distance.
class PriorMap {
 public:
  struct Pair {
    float distance_m;
    std::int32_t first, second;  ///< first < second
  };

  PriorMap(PriorMapData earlier, double pair_max_m);

  std::size_t size() const { return landmarks_.size(); }
  const PriorLandmark& operator[](std::int32_t i) const { return landmarks_[i]; }

  /// Calls visit(index) for all landmarks within `radius_m` of the point and some beyond, in an
  /// order that depends on the map only.
  template <class Visit>
  void near(const Eigen::Vector2d& p_map, double radius_m, Visit&& visit) const {
    grid_.near(p_map.x(), p_map.y(), radius_m, visit);
  }

  /// Returns the range [begin, end) of pairs() with distances in [least_m, most_m).
  std::pair<std::size_t, std::size_t> pairs_at(double least_m, double most_m) const;
  const std::vector<Pair>& pairs() const { return pairs_; }

  /// Returns the probability that another visit with a landmark in view detects it again.
  double repeat(std::int32_t i) const { return repeat_[i]; }

  /// Returns true if the earlier drive would have mapped a tree there, or if that is unknown.
  bool was_seen(const Eigen::Vector2d& p_map) const;

  /// Returns the max distance between parts of one clump [m].
  double clump_reach_m() const;

  /// Standard deviation of the known widths of the landmarks [m].
  double width_sd_m() const { return width_sd_m_; }
  /// Median distance of a landmark to its nearest neighbour [m].
  double spacing_m() const { return spacing_m_; }

 private:
  std::vector<PriorLandmark> landmarks_;
  geometry::PointGrid grid_{1.0};
  std::vector<Pair> pairs_;  ///< sorted by distance
  std::vector<double> repeat_;
  bool is_seen_known_;
  geometry::PointGrid seen_;  ///< has a point in each cell that the earlier drive saw
  double width_sd_m_ = 0.0;
  double spacing_m_ = 0.0;
};

}  // namespace orchard::pose
