// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Returns the covariance of a fix (x, y, yaw) [m, m, rad]: as stated, or as configured for what it
/// does not state.
Eigen::Matrix3d fix_covariance(const PoseFix& fix, const PoseConfig& config);

/// Localiser of mode `fixes`: each fix is a pose by itself, as in the paper, where the robot is
/// placed by hand (Shalal et al. 2013, section 6.1). Fixes without yaw point along the way driven,
/// anew every heading_baseline_m; before the first there is no pose.
class Fixes : public Localiser {
 public:
  explicit Fixes(const PoseConfig& config) : config_(config) {}

  void add(const Measurement& measurement) override;
  std::optional<PoseEstimate> estimate() const override { return estimate_; }

 private:
  PoseConfig config_;
  std::optional<PoseFix> baseline_start_;  ///< fix without yaw
  std::optional<PoseEstimate> estimate_;
};

}  // namespace orchard::pose
