// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/visibility.hpp"

namespace orchard::pose {

/// Something that one scan showed, in base as it was at the scan's utime.
struct Sighting {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  double width_m = 0.0;  ///< 0 = unknown
  double width_sd_m = 0.0;
};

/// Where a scanner would see a trunk that nothing hides: learnt from where it has seen any, since
/// how it is mounted and how far round it observations are not told. Points are in base, or in any
/// frame that goes with it.
class SightField {
 public:
  explicit SightField(double sure_range_m) : sure_range_m_(sure_range_m) {}

  void learn(const std::vector<Sighting>& sightings);

  bool covers(const Eigen::Vector2d& p_base) const;

  double range_m() const;  ///< within which it sees for sure

 private:
  static constexpr std::size_t kBins = 36;
  static constexpr int kSureSightings = 5;
  static constexpr double kSureFraction = 0.85;

  double sure_range_m_;
  double farthest_m_ = 0.0;
  std::array<int, kBins> num_seen_{};
};

/// What a scan's sightings hide.
geometry::OcclusionTest occlusion_by(const std::vector<Sighting>& sightings);

}  // namespace orchard::pose
