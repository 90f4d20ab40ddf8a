// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace orchard::geometry {

/// A disc as seen from the origin.
struct Outline {
  double distance_m = 0.0;  ///< to its centre
  double bearing_rad = 0.0;
  double half_rad = 0.0;  ///< half the angle between its tangents; pi/2 from inside
};
Outline outline_of(const Eigen::Vector2d& centre, double radius_m);

/// Index of the sector, of `num` equal ones about the origin, that contains a point; sector 0
/// begins at bearing -pi.
std::size_t sector_of(const Eigen::Vector2d& p, std::size_t num);

/// Occlusion test with the trunks of one scan: tells whether a trunk at a position could not have
/// been seen by the scanner, which is at the origin.
///
/// Made for landmarks, whose position and width are uncertain by centimetres: every trunk gets a
/// border of half a trunk. Exact visibility is computed elsewhere: from the beams themselves
/// (mapping/free_space), and in the simulator's truth, which must not share code with the
/// code it judges.
class OcclusionTest {
 public:
  /// Adds a trunk that was seen.
  void add(const Eigen::Vector2d& p, double width_m);

  /// True if a trunk at p is hidden by one of the added trunks.
  bool occludes(const Eigen::Vector2d& p) const;

 private:
  struct Shadow {
    Eigen::Vector2d direction;  ///< unit vector
    double range_m;
    double half_width_m;
  };
  std::vector<Shadow> shadows_;
};

}  // namespace orchard::geometry
