// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace orchard::pose {

/// A landmark of an earlier day's map.
struct PriorLandmark {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();  ///< [m]
  double width_m = 0.0;                             ///< 0 = unknown
  double weight = 1.0;                              ///< against its doubles: how often it was seen
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

  PriorMap(std::vector<PriorLandmark> landmarks, double pair_max_m);

  std::size_t size() const { return landmarks_.size(); }
  const PriorLandmark& operator[](std::int32_t i) const {
    return landmarks_[static_cast<std::size_t>(i)];
  }

  /// Calls visit(index) for everything within `radius_m` of the point and some beyond, in an order
  /// that depends on the map alone.
  template <class Visit>
  void near(const Eigen::Vector2d& p_map, double radius_m, Visit&& visit) const {
    const std::int64_t x_last = cell(p_map.x() + radius_m), y_last = cell(p_map.y() + radius_m);
    for (std::int64_t cx = cell(p_map.x() - radius_m); cx <= x_last; ++cx) {
      for (std::int64_t cy = cell(p_map.y() - radius_m); cy <= y_last; ++cy) {
        const auto found = cells_.find(key(cx, cy));
        if (found == cells_.end()) continue;
        for (std::int32_t i = found->second.first; i < found->second.second; ++i) {
          visit(order_[static_cast<std::size_t>(i)]);
        }
      }
    }
  }

  /// Pairs whose distance lies in [least, most]: a range of pairs().
  std::pair<std::size_t, std::size_t> pairs_at(double least_m, double most_m) const;
  const std::vector<Pair>& pairs() const { return pairs_; }

  /// Standard deviation of the widths of the landmarks that have one [m].
  double width_sd_m() const { return width_sd_m_; }
  /// Median distance to the nearest landmark [m].
  double spacing_m() const { return spacing_m_; }

 private:
  static constexpr double kCellM = 1.0;

  static std::int64_t cell(double coordinate_m) {
    return static_cast<std::int64_t>(std::floor(coordinate_m / kCellM));
  }
  static std::uint64_t key(std::int64_t cx, std::int64_t cy) {
    return (static_cast<std::uint64_t>(cx) << 32) ^ (static_cast<std::uint64_t>(cy) & 0xffffffffu);
  }

  std::vector<PriorLandmark> landmarks_;
  std::unordered_map<std::uint64_t, std::pair<std::int32_t, std::int32_t>> cells_;
  std::vector<std::int32_t> order_;  ///< indices by cell
  std::vector<Pair> pairs_;          ///< by distance
  double width_sd_m_ = 0.0;
  double spacing_m_ = 0.0;
};

}  // namespace orchard::pose
