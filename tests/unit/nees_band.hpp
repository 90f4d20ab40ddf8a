// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace orchard::test {

/// Interval that holds the mean of independent NEES in 95 % of cases if the stated covariances are
/// those of the errors. NEES, the normalised error squared e^T P^-1 e, is chi-square distributed.
struct NeesBand {
  double least, most;
};

/// The band for the mean over `num` runs of an error of `dof` dimensions. One error of each run:
/// the errors along one drive are not independent. Quantiles by Wilson and Hilferty 1931, to 1 %
/// from 6 degrees of freedom on.
inline NeesBand nees_band(int dof, int num) {
  const double k = static_cast<double>(dof) * num, v = 2.0 / (9.0 * k);
  constexpr double kNormal975 = 1.959964;
  const auto quantile = [&](double z) { return k * std::pow(1.0 - v + z * std::sqrt(v), 3); };
  return {quantile(-kNormal975) / num, quantile(kNormal975) / num};
}

}  // namespace orchard::test
