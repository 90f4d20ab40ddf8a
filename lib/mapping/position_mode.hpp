// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace orchard::mapping {

/// An observation in map with its weight.
struct WeightedPoint {
  Eigen::Vector2d p_map;
  double weight = 0.0;  ///< inverse variance [1 / m2]
};

/// Mode of a set of points.
struct PositionMode {
  Eigen::Vector2d p_map;
  Eigen::Matrix2d covariance;  ///< of p_map [m2]
};

/// Computes the mode of the points, weighted by inverse variance: mean shift from `start_map` with
/// a Gaussian kernel that shrinks to `kernel_m`, so that a few observations of another object do
/// not move the landmark. The covariance is that of the kernel-weighted mean with N - 1, N the
/// effective number of points; of a single point its own. Needs at least one point.
PositionMode position_mode(const std::vector<WeightedPoint>& points,
                           const Eigen::Vector2d& start_map, double kernel_m);

/// Mean square deviations of the points from `centre_map`, weighted by inverse variance [m2]. Needs
/// at least one point.
Eigen::Matrix2d scatter_around(const Eigen::Vector2d& centre_map,
                               const std::vector<WeightedPoint>& points);

/// Cache of landmark positions by index, which makes the cost per scan constant. Positions of
/// landmarks with few observations are not cached but computed every time.
class ModeCache {
 public:
  /// The mode of a landmark with `num_observations` observations: the cached one, or make() if the
  /// number has grown by 1/16 or by kFew since it was computed.
  template <class Make>
  const PositionMode& at(std::int32_t index, std::int32_t num_observations, Make&& make) {
    if (num_observations <= kFew) return few_ = make();
    const auto i = static_cast<std::size_t>(index);
    if (i >= known_.size()) known_.resize(i + 1 + known_.size() / 4);
    Known& known = known_[i];
    const std::int32_t num_new = num_observations - known.num_observations;
    if (num_new >= kFew || 16 * num_new >= num_observations) {
      known = {make(), num_observations};
    }
    return known.mode;
  }

  /// Makes the next at() recompute the mode.
  void forget(std::int32_t index) {
    if (static_cast<std::size_t>(index) < known_.size()) known_[index].num_observations = 0;
  }

  std::size_t num_bytes() const { return known_.capacity() * sizeof(Known); }

 private:
  /// derived: the mode of so few costs microseconds.
  static constexpr std::int32_t kFew = 32;
  struct Known {
    PositionMode mode;
    std::int32_t num_observations = 0;
  };
  std::vector<Known> known_;
  PositionMode few_;
};

}  // namespace orchard::mapping
