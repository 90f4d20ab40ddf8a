// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/rigid_fit2.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace orchard::geometry {

using Eigen::Vector2d;

RigidFit2 fit_rigid(const std::vector<Vector2d>& p_a, const std::vector<Vector2d>& p_b,
                    const std::vector<double>& weights) {
  const bool is_weighted = !weights.empty();
  if (p_a.empty() || p_a.size() != p_b.size() || (is_weighted && weights.size() != p_a.size())) {
    throw std::invalid_argument(
        "fit_rigid: needs equally many points in both sets, and at least one");
  }
  RigidFit2 fit;
  double total = 0.0;
  for (std::size_t i = 0; i < p_a.size(); ++i) {
    const double weight = is_weighted ? weights[i] : 1.0;
    fit.mean_a += weight * p_a[i];
    fit.mean_b += weight * p_b[i];
    total += weight;
  }
  if (!(total > 0.0)) return {};
  fit.mean_a /= total;
  fit.mean_b /= total;
  double dot = 0.0, cross = 0.0;
  for (std::size_t i = 0; i < p_a.size(); ++i) {
    const double weight = is_weighted ? weights[i] : 1.0;
    const Vector2d a = p_a[i] - fit.mean_a, b = p_b[i] - fit.mean_b;
    dot += weight * (a.x() * b.x() + a.y() * b.y());
    cross += weight * (b.x() * a.y() - b.y() * a.x());
    fit.mean_square_b_m2 += weight * b.squaredNorm() / total;
  }
  fit.T_a_b.yaw_rad = std::atan2(cross, dot);
  const Vector2d shift_m = fit.mean_a - rotation(fit.T_a_b) * fit.mean_b;
  fit.T_a_b.x_m = shift_m.x();
  fit.T_a_b.y_m = shift_m.y();
  return fit;
}

Pose2 pose_from_two_pairs(const Vector2d& a1, const Vector2d& a2, const Vector2d& b1,
                          const Vector2d& b2) {
  const Vector2d a = a2 - a1, b = b2 - b1;
  Pose2 T_a_b;
  T_a_b.yaw_rad = wrap_angle_rad(std::atan2(a.y(), a.x()) - std::atan2(b.y(), b.x()));
  const Vector2d shift_m = 0.5 * (a1 + a2) - rotation(T_a_b) * (0.5 * (b1 + b2));
  T_a_b.x_m = shift_m.x();
  T_a_b.y_m = shift_m.y();
  return T_a_b;
}

}  // namespace orchard::geometry
