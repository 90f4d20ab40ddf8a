// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::geometry {

/// derived: ratio of a normal distribution's standard deviation to its median absolute deviation.
inline constexpr double kMadToSd = 1.4826;

/// derived: gates on the squared Mahalanobis distance of a planar residual: quantiles of the
/// chi-square distribution of 2 degrees of freedom, -2 ln(1 - p).
inline constexpr double kChiSquare2_997 = 11.8;  ///< three sigma: 99.73 %
inline constexpr double kChiSquare2_999 = 13.8;  ///< 99.9 %

/// The square, for example the variance of a standard deviation.
inline double square(double x) { return x * x; }

/// The value of rank floor(fraction n) in ascending order, at most the largest; 0 for no values.
///
/// The result is always one of the values, never interpolated.
double quantile(std::vector<double> values, double fraction);

/// The quantile at 0.5: for an even number of values the upper of the two middle ones.
double median(std::vector<double> values);

/// The textbook median: for an even number of values the mean of the two middle ones; 0 for no
/// values. For figures that are compared with those of other programs.
double midpoint_median(std::vector<double> values);

/// Robust standard deviation about zero: kMadToSd times the median absolute value.
double robust_sd(std::vector<double> deviations);

/// Area under the ROC curve: the probability that a positive scores higher than a negative, ties
/// counting half. 0.5 is chance level, and the result when either list is empty. Scores must be
/// finite.
double roc_area(const std::vector<double>& positives, const std::vector<double>& negatives);

}  // namespace orchard::geometry
