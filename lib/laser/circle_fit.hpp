// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace orchard::laser {

/// Measurements of one object for the circle fit: the ranges of its beams and the bearings of its
/// two sides.
struct Arc {
  std::vector<double> ranges_m;
  std::vector<double> cosines, sines;  ///< of the beams' bearings, ascending
  /// Bearings of the tangents to the two sides; they enclose all beams.
  double low_side_rad = 0.0;
  double high_side_rad = 0.0;
  double low_side_sd_rad = 0.0;  ///< 1-sigma; 0 = this side is hidden
  double high_side_sd_rad = 0.0;
};

/// A circle fitted to the visible part of an object, in the frame of the arc.
struct CircleFit {
  double x_m = 0.0;  ///< centre
  double y_m = 0.0;
  double radius_m = 0.0;
  /// Covariance of (x, y, radius): xx, xy, yy, x radius, y radius, radius radius [m2]. Scaled by
  /// chi2 per degree of freedom where that exceeds 1.
  std::array<double, 6> covariance{};
  double chi2 = 0.0;  ///< sum over ranges and sides; outliers are down-weighted
  int dof = 0;        ///< degrees of freedom: number of measurements less 3

  /// About 1 for a circle measured with the expected noise; 0 without degrees of freedom.
  double chi2_per_dof() const { return dof > 0 ? chi2 / dof : 0.0; }
};

/// A radius known beforehand, as from other trunks.
struct RadiusPrior {
  double mean_m = 0.0;
  double sd_m = 0.0;
};

/// Options of the circle fit.
struct CircleSearch {
  /// Initial circle in the frame of the arc; none = the arc is taken for the whole visible half.
  std::optional<CircleFit> near;
  double settled_m = 1e-5;  ///< convergence threshold for a step of centre or radius
  /// Abandons the fit early when it is unlikely to become good (see tuning::kGoodFit).
  bool only_good = false;
  std::optional<RadiusPrior> prior;  ///< counts as one more measurement
};

/// Fits a circle to ranges and sides by maximum likelihood (Gauss-Newton): a beam measures the near
/// side of the circle, a side is a tangent to it. The variance of a range is the range noise plus
/// the change of the surface's range within the beam's footprint. Beams at grazing incidence have
/// no weight, outliers less (Huber). Hidden sides are left out; the radius then depends on the
/// curvature alone.
///
/// `range_sd_m` is 1-sigma of one range. None for fewer than three measurements, or when they
/// determine no circle with a radius in (1 mm, radius_max_m).
std::optional<CircleFit> fit_circle(const Arc& arc, double bearing_step_rad, double range_sd_m,
                                    double radius_max_m, const CircleSearch& search = {});

/// Chi2 of an arc's ranges about the best straight line, with `range_sd_m` as the noise of a range.
/// Degrees of freedom: number of beams less 2.
double line_chi2(const Arc& arc, double range_sd_m);

}  // namespace orchard::laser
