// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::geometry {

/// Standard deviation of a normal distribution per median of its absolute deviations.
inline constexpr double kMadToSd = 1.4826;

/// Gates on the squared Mahalanobis distance of a planar residual: quantiles of the chi-square
/// distribution of 2 degrees of freedom, -2 ln(1 - p).
inline constexpr double kChiSquare2_997 = 11.8;  ///< three sigma: 99.73 %
inline constexpr double kChiSquare2_999 = 13.8;  ///< 99.9 %

/// A variance from a standard deviation.
inline double square(double x) { return x * x; }

/// The value of rank floor(fraction n) in rising order, the largest at most; 0 for no values.
///
/// Always one of the values; never an interpolation.
double quantile(std::vector<double> values, double fraction);

/// The quantile of one half: for an even number of values the upper of the two in the middle.
double median(std::vector<double> values);

/// The median as textbooks have it: for an even number of values the mean of the two in the middle;
/// 0 for no values. For figures that are compared with those of other programs.
double midpoint_median(std::vector<double> values);

/// Robust standard deviation of deviations about zero: kMadToSd times their median absolute value.
double robust_sd(std::vector<double> deviations);

/// Area under the ROC curve: how often a positive scores higher than a negative, ties counting
/// half. 0.5 is chance; 0.5 too when either list is empty. Scores must be finite.
double roc_area(const std::vector<double>& positives, const std::vector<double>& negatives);

}  // namespace orchard::geometry
