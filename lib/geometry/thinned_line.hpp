// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::geometry {

/// Simplifies a line: omitted points lie within `tolerance_m` of the line through the remaining
/// ones, which include the first and the last. One pass with a cone of directions that all omitted
/// points allow (Williams 1978, Zhao and Saalfeld 1997).
std::vector<Eigen::Vector2d> thinned_line(const std::vector<Eigen::Vector2d>& line,
                                          double tolerance_m);

}  // namespace orchard::geometry
