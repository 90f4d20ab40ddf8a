// SPDX-License-Identifier: BSD-3-Clause
#include "pose/repeat_model.hpp"

#include <algorithm>
#include <cmath>

#include "pose/tuning.hpp"

namespace orchard::pose {
namespace {

// physical: the crowns of one stump reach a metre, and not to the next tree.
constexpr double kClumpReachMax_m = 1.0;
constexpr double kClumpReachSpacings = 0.6;

/// Continued fraction of the incomplete beta function by Lentz's method (Abramowitz and Stegun
/// 26.5.8), for x below the mean.
double beta_fraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;  // derived: above the smallest double
  const auto nonzero = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1.0;
  double d = 1.0 / nonzero(1.0 - (a + b) * x / (a + 1.0));
  double fraction = d;
  for (int m = 1; m <= 200; ++m) {
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    d = 1.0 / nonzero(1.0 + even * d);
    c = nonzero(1.0 + even / c);
    fraction *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    d = 1.0 / nonzero(1.0 + odd * d);
    c = nonzero(1.0 + odd / c);
    const double factor = d * c;
    fraction *= factor;
    if (std::abs(factor - 1.0) < 1e-12) break;
  }
  return fraction;
}

/// Cumulative distribution of Beta(a, b) at x in (0, 1).
double beta_cdf(double a, double b, double x) {
  const double log_front =
      std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
  const double front = std::exp(log_front);
  if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(a, b, x) / a;
  return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

}  // namespace

double detection_rate(double num_seen, double num_chances) {
  return (std::min(num_seen, num_chances) + 0.5) / (num_chances + 1.0);
}

double probability_seen_again(double rate, double rate_min) {
  if (rate >= 1.0 || rate_min <= 0.0) return 1.0;
  if (rate <= 0.0 || rate_min >= 1.0) return 0.0;
  const double below =
      beta_cdf(kObservationsWorth * rate, kObservationsWorth * (1.0 - rate), rate_min);
  return std::clamp(1.0 - below, 0.0, 1.0);
}

double clump_reach_m(double spacing_m) {
  return std::min(kClumpReachMax_m, kClumpReachSpacings * spacing_m);
}

}  // namespace orchard::pose
