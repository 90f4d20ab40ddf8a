// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::view {

/// The line with fewer points: those left out lie within `tolerance_m` of the line through those
/// kept, of which the first and last are two. One pass (a cone of directions that every point left
/// out allows: Williams 1978, Zhao and Saalfeld 1997).
std::vector<Eigen::Vector2d> thinned_line(const std::vector<Eigen::Vector2d>& line,
                                          double tolerance_m);

}  // namespace orchard::view
