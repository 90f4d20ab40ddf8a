// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/visibility.hpp"
#include "pose/tuning.hpp"

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
  // derived: sectors of 10 degrees, each seen often enough that chance left none out.
  static constexpr std::size_t kBins = 36;
  static constexpr int kObservationsMin = 5;

  double sure_range_m_;
  double farthest_m_ = 0.0;
  std::array<int, kBins> num_seen_{};
};

/// Returns the occlusion test for the objects of a scan.
geometry::OcclusionTest occlusion_by(const std::vector<ScanObservation>& observations);

/// Sensor coverage: the range at which objects are detected, per direction of base, learnt from the
/// detections. It separates landmarks that should have been observed again from those out of view.
class SensorCoverage {
 public:
  /// Adds an observation of any object.
  void add_observation(const Eigen::Vector2d& p_base) {
    range_max_m_ = std::max(range_max_m_, p_base.norm());
  }

  /// Adds an observation of a confirmed landmark.
  void add_reobservation(const Eigen::Vector2d& p_base) {
    double& reach_m = reach_m_[bin(p_base)];
    const double range_m = p_base.norm();
    // Decays to the usual range after a single observation far beyond the rest.
    reach_m = range_m > reach_m ? range_m : std::max(range_m, 0.999 * reach_m);
  }

  /// True if an object at this position is reliably detected unless it is occluded.
  bool in_view(const Eigen::Vector2d& p_base) const {
    const int b = bin(p_base);
    const double reach_m =
        std::min({reach_m_[b], reach_m_[(b + 1) % kBins], reach_m_[(b + kBins - 1) % kBins]});
    return p_base.norm() < kCoverageFraction * reach_m;
  }

  /// Returns the range of the farthest observation so far [m].
  double range_max_m() const { return range_max_m_; }

 private:
  static constexpr int kBins = 36;  // derived: sectors of 10 degrees

  static int bin(const Eigen::Vector2d& p_base) {
    return static_cast<int>(geometry::sector_of(p_base, kBins));
  }

  std::array<double, kBins> reach_m_{};
  double range_max_m_ = 0.0;
};

}  // namespace orchard::pose
