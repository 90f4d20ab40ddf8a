// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "mapping/compare/visibility.hpp"
#include "unit/mapping/compare/two_drives.hpp"

namespace orchard::mapping {

/// As drive_through(), for blocks of many thousand trees: every tree beside an aisle that was
/// driven is looked at as often as any other, and nothing hides one. `drive.rate` and `reach_m` say
/// how often.
inline DrivenMap drive_through_large(const Block& block, const Drive& drive, Dice& dice) {
  constexpr double kStep_m = 0.5;
  constexpr int kObservationsPerStep = 5;  // ten per second at 1 m/s
  DrivenMap map;
  const double phase_rad = dice.uniform(0, 6.28);
  std::int64_t utime = 1000000;
  for (int aisle = drive.first_aisle; aisle <= drive.last_aisle; ++aisle) {
    const bool is_forward = (aisle - drive.first_aisle) % 2 == 0;
    const double y_m = (aisle - 0.5) * block.row_spacing_m;
    const double length_m = drive.along_max_m - drive.along_min_m;
    for (double s_m = 0.0; s_m <= length_m; s_m += kStep_m) {
      const double x_m = is_forward ? drive.along_min_m + s_m : drive.along_max_m - s_m;
      const Eigen::Vector2d p = bent(drive, phase_rad, {x_m, y_m});
      pose::PoseEstimate pose;
      pose.utime = utime += 500000;
      pose.x_m = p.x();
      pose.y_m = p.y();
      pose.yaw_rad = std::remainder((is_forward ? 0.0 : 3.14159265) + drive.T_map_block.yaw_rad,
                                    6.283185307179586);
      map.trajectory.push_back(pose);
    }
  }
  for (std::size_t i = 0; i < block.trees.size(); ++i) {
    const TrueTree& t = block.trees[i];
    if (!t.stands || t.p.x() < drive.along_min_m || t.p.x() > drive.along_max_m) continue;
    int num_seen = 0;
    for (const int aisle : {t.row, t.row + 1}) {
      if (aisle < drive.first_aisle || aisle > drive.last_aisle) continue;
      const double aside_m = 0.5 * block.row_spacing_m;
      const double in_reach_m = 2.0 * std::sqrt(drive.reach_m * drive.reach_m - aside_m * aside_m);
      const int num_observations = static_cast<int>(in_reach_m / kStep_m) * kObservationsPerStep;
      for (int observation = 0; observation < num_observations; ++observation)
        num_seen += dice.uniform(0, 1) < drive.rate;
    }
    if (num_seen < 3) continue;
    const int id = static_cast<int>(map.landmarks.size()) + 1;
    map.landmarks.push_back(mapped_tree(t, bent(drive, phase_rad, t.p), id, num_seen, drive, dice));
    map.tree_of.push_back(static_cast<int>(i));
  }
  return map;
}

}  // namespace orchard::mapping
