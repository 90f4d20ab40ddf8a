// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "laser/circle_fit.hpp"

namespace orchard::laser {

/// Sum of squares of an arc's ranges about the best straight surface, over the noise of a range;
/// of three beams or more, two of which the line takes.
double line_chi2(const Arc& arc, double range_sd_m);

}  // namespace orchard::laser
