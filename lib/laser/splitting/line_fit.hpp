// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/circle_fit.hpp"

namespace orchard::laser {

/// Chi2 of an arc's ranges about the best straight line, with `range_sd_m` as the noise of a range.
/// Degrees of freedom: number of beams less 2.
double line_chi2(const Arc& arc, double range_sd_m);

}  // namespace orchard::laser
