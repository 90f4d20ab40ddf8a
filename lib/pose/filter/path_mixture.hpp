// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pose/trajectory.hpp"

namespace orchard::pose {

/// One credible path.
struct CrediblePath {
  double probability = 1.0;
  std::vector<PoseEstimate> poses;
};

/// Returns the mean of credible paths over the same times, with the covariance of their mixture: of
/// all estimates it has the smallest expected squared error.
///
/// Paths: one or more, of equally many poses; probabilities need not sum to 1. Headings are
/// averaged about those of the first, the likeliest.
std::vector<PoseEstimate> mean_path(const std::vector<CrediblePath>& paths);

/// Returns the largest standard deviation of these paths' positions about their mean [m]; 0 unless
/// it exceeds what the likeliest, the first, says of its own position there.
double notable_spread_m(const std::vector<CrediblePath>& paths);

}  // namespace orchard::pose
