// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "laser/scan.hpp"

namespace orchard::test {

/// Centres in base of the narrow things that stand free in a scan, cut at range jumps without any
/// of the detector's parts. The limits are those of pullally_drive_1: 0.08 to 0.40 m wide, 0.9 to
/// 7 m away, not straight behind; the laser sits in base's origin.
std::vector<Eigen::Vector2d> free_standing(const laser::Scan& scan);

}  // namespace orchard::test
