// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::pose {

/// Returns the regularity of a planting pattern: the standard deviation [m] of the residuals of a
/// wrong registration, i.e. after the map is shifted by the offset between two neighbours. For rows
/// it is their irregularity, because a shift by a tree or a row fits nearly as well as the correct
/// one; for irregularly planted trees it grows with their spacing. Estimated from the lower
/// quartile of the distances to the nearest tree; infinite for fewer than four trees.
double lattice_residual_sd_m(const std::vector<Eigen::Vector2d>& trees);

}  // namespace orchard::pose
