// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace orchard::geometry {

/// How a disc appears from the origin.
struct Outline {
  double distance_m = 0.0;  ///< to its centre
  double bearing_rad = 0.0;
  double half_rad = 0.0;  ///< half the angle between its tangents; a quarter turn from inside
};
Outline outline_of(const Eigen::Vector2d& centre, double radius_m);

/// Which of `num` equal sectors about the origin a point lies in: 0 begins behind, at -pi.
std::size_t sector_of(const Eigen::Vector2d& p, std::size_t num);

/// What the trunks that a scan showed hide from its scanner, which is the origin: tells whether a
/// trunk at some place could not have been seen.
///
/// Made for landmarks, whose position and width are uncertain by centimetres, so everything has a
/// border of half a trunk. What is exact is elsewhere: the beams themselves tell what they passed
/// (mapping/existence/free_space), and the simulator's truth must not share code with what it
/// judges.
class OcclusionTest {
 public:
  /// A trunk that was seen.
  void add(const Eigen::Vector2d& p, double width_m);

  /// Whether a trunk at p lies behind one of them.
  bool hides(const Eigen::Vector2d& p) const;

 private:
  struct Shadow {
    Eigen::Vector2d direction;  ///< unit vector
    double range_m;
    double half_width_m;
  };
  std::vector<Shadow> shadows_;
};

}  // namespace orchard::geometry
