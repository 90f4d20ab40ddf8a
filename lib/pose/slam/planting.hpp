// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::pose {

/// How regularly trees are planted: the standard deviation [m] of where a tree stands when the map
/// is moved by the distance between two neighbours. Rows give their irregularity, so that the next
/// tree or row is known to fit nearly as well; trees in no order give what density gives, as many
/// metres as they stand apart. Its Gaussian is what a wrong registration makes of residuals. Reads
/// it off at the lower quartile of the distances; none (infinite) for fewer than four trees.
double planted_sd_m(const std::vector<Eigen::Vector2d>& trees);

}  // namespace orchard::pose
