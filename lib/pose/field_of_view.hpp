// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/visibility.hpp"

namespace orchard::pose {

/// An object observed in one scan, in base at the scan's utime.
struct ScanObservation {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  double width_m = 0.0;  ///< 0 = unknown
  double width_sd_m = 0.0;
};

/// Sensor coverage: the directions and ranges in which an unoccluded trunk would be detected. It is
/// learnt from the detections, because the scanner's field of view is not configured. Points are in
/// base, or in any frame fixed to it.
class FieldOfView {
 public:
  explicit FieldOfView(double sure_range_m) : sure_range_m_(sure_range_m) {}

  void learn(const std::vector<ScanObservation>& observations);

  bool covers(const Eigen::Vector2d& p_base) const;

  double range_m() const;  ///< range of reliable detection

 private:
  static constexpr std::size_t kBins = 36;
  static constexpr int kObservationsMin = 5;
  static constexpr double kSureFraction = 0.85;

  double sure_range_m_;
  double farthest_m_ = 0.0;
  std::array<int, kBins> num_seen_{};
};

/// Returns the occlusion test for the objects of a scan.
geometry::OcclusionTest occlusion_by(const std::vector<ScanObservation>& observations);

}  // namespace orchard::pose
