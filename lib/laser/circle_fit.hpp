// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace orchard::laser {

/// What one object's beams returned, and where its sides are.
struct Arc {
  std::vector<double> ranges_m;
  std::vector<double> cosines, sines;  ///< of the beams' bearings, ascending
  /// Bearings of the tangents to its sides, below and above all beams.
  double low_side_rad = 0.0;
  double high_side_rad = 0.0;
  double low_side_sd_rad = 0.0;  ///< 1-sigma; 0 = that side is not seen
  double high_side_sd_rad = 0.0;
};

/// A circle through what shows of an object, in the frame of the arc.
struct CircleFit {
  double x_m = 0.0;  ///< of the centre
  double y_m = 0.0;
  double radius_m = 0.0;
  /// Of (x, y, radius): xx, xy, yy, x radius, y radius, radius radius [m2]. Grown by the misfit
  /// where that is larger than the noise.
  std::array<double, 6> covariance{};
  double chi2 = 0.0;  ///< of ranges and sides against their noise; outliers count less
  int dof = 0;        ///< how many of them are more than the circle needs

  /// About 1 for a circle seen through the noise; 0 where nothing is left over to judge by.
  double chi2_per_dof() const { return dof > 0 ? chi2 / dof : 0.0; }
};

/// How a circle is looked for.
struct CircleSearch {
  /// Where to begin, in the frame of the arc; none = as if the arc were the whole of the circle.
  std::optional<CircleFit> near;
  double settled_m = 1e-5;  ///< the last step, of the centre and of the radius
  /// Whether only a good fit is of use: it is given up as soon as none is to be expected.
  bool only_good = false;
};

/// Chi2 per degree of freedom below which something fits as well as noise lets it.
inline constexpr double kGoodFit = 3.0;

/// Fits a circle to ranges and sides by Gauss-Newton on their maximum likelihood: a beam returns
/// the circle's near side, a side is its tangent. Ranges are weighed by the noise and by how fast
/// the surface recedes there; beams that graze it are left to the sides; outliers weigh less
/// (Huber). A hidden side is left out: then only the arc's bend tells the radius.
///
/// `range_sd_m` is 1-sigma of one range. None for fewer than three measurements, or when they
/// determine no circle of a radius in (1 mm, radius_max_m).
std::optional<CircleFit> fit_circle(const Arc& arc, double bearing_step_rad, double range_sd_m,
                                    double radius_max_m, const CircleSearch& search = {});

}  // namespace orchard::laser
