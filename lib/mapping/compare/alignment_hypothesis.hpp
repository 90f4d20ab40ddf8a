// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <queue>
#include <tuple>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::mapping {

/// An alignment that lays two points of one map on two of another, and how the points around them
/// agree.
struct AlignmentHypothesis {
  geometry::Pose2 T_a_b;
  Eigen::Vector2d middle_a{0.0, 0.0};
  int num_agreeing = 0;  ///< inliers
  double sum_m2 = 0.0;
  double sum_width_m = 0.0;  ///< width differences b - a of the inliers
  double sum_width_m2 = 0.0;

  double place_m2() const { return sum_m2 / num_agreeing; }
  double width_m2() const {
    const double mean_m = sum_width_m / num_agreeing;
    return sum_width_m2 / num_agreeing - mean_m * mean_m;
  }
};

/// Log-likelihood ratio of the inlier support against the null hypothesis. The noise is estimated
/// from the inliers and, while they are few, shrunk towards that of the null hypothesis.
double agreement(const AlignmentHypothesis& h, double null_place_m2, double null_width_m2);

/// Order in which hypotheses are refined: alternately by agreement and by number of inliers, each
/// hypothesis once. A large map has millions, of which only the first are asked for: not sorted.
class MostPromising {
 public:
  explicit MostPromising(const std::vector<AlignmentHypothesis>& hypotheses);

  /// Index of the next hypothesis; none after the last.
  std::optional<std::size_t> next();

 private:
  struct Rank {
    double first = 0.0, second = 0.0;  ///< the larger, the earlier
    std::size_t index = 0;             ///< of equals the smaller one first

    bool operator<(const Rank& other) const {
      return std::tie(first, second, other.index) < std::tie(other.first, other.second, index);
    }
  };
  using Queue = std::priority_queue<Rank>;

  std::array<Queue, 2> queues_;
  std::size_t turn_ = 0;
  std::vector<bool> is_taken_;
};

}  // namespace orchard::mapping
