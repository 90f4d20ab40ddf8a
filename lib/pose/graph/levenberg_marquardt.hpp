// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace orchard::pose {

/// Change of all unknowns in one iteration.
struct LeastSquaresStep {
  Eigen::VectorXd change;
  double gain = 0.0;  ///< decrease of the cost predicted by the linear model
};

/// Cost of a residual, and the factor by which a robust loss scales its square.
struct Loss {
  double cost = 0.0;
  double slope = 1.0;
};

/// Returns half the square or, if `robust`, the Cauchy loss with this scale [sigma].
inline Loss loss_of(double square, bool robust, double scale) {
  if (!robust) return {0.5 * square, 1.0};
  const double scale2 = scale * scale;
  const double sum = 1.0 + square / scale2;
  return {0.5 * scale2 * std::log(sum), 1.0 / sum};
}

/// Minimises a sum of squares by Levenberg-Marquardt with the trust region and the tolerances of
/// Ceres; returns false if it failed.
///
/// `values`: start and result. `cost(values)`: the cost. `find_step(values, damping)`: the step
/// that solves the equations with their diagonal multiplied by 1 + damping, as an optional; none if
/// they are singular or nothing is gained. `norm(values)`: the norm of the unknowns among them.
template <class Cost, class FindStep, class Norm>
bool minimise(Eigen::VectorXd& values, int iterations_max, double tolerance, const Cost& cost,
              const FindStep& find_step, const Norm& norm) {
  // Defaults of Ceres.
  constexpr double kFirstRadius = 1e4;
  constexpr double kRadiusMax = 1e16;
  constexpr double kGainMin = 1e-3;        // min fraction of the predicted decrease of the cost
  constexpr double kStepTolerance = 1e-8;  // relative to the norm of the unknowns
  constexpr int kInvalidStepsMax = 5;      // in a row
  double now = cost(values);
  if (!std::isfinite(now)) return false;
  double radius = kFirstRadius, shrink = 2.0;
  int num_invalid = 0;
  for (int i = 0; i < iterations_max; ++i) {
    const std::optional<LeastSquaresStep> step = find_step(values, 1.0 / radius);
    if (!step) {
      if (++num_invalid >= kInvalidStepsMax) return false;
      radius /= std::exchange(shrink, 2.0 * shrink);
      continue;
    }
    num_invalid = 0;
    const Eigen::VectorXd there = values + step->change;
    const double then = cost(there);
    if (step->change.norm() <= kStepTolerance * (norm(values) + kStepTolerance)) return true;
    if (std::abs(now - then) <= tolerance * now) return true;
    const double gained = (now - then) / step->gain;
    if (gained > kGainMin) {  // false if the cost is NaN
      values = there;
      now = then;
      radius =
          std::min(kRadiusMax, radius / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gained - 1.0, 3)));
      shrink = 2.0;
    } else {
      radius /= std::exchange(shrink, 2.0 * shrink);
    }
  }
  return true;
}

}  // namespace orchard::pose
