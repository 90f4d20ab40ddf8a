// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/position_mode.hpp"

#include <algorithm>

namespace orchard::mapping {
namespace {

/// derived: the kernel shrinks for six rounds and converges in six more.
constexpr int kRounds = 12;

/// exp(a) for a in [-30, 0], relative error 1e-8 at -30 and 1e-13 from -8 on: Taylor series of
/// exp(a / 64), raised to the power 64. Without call, table or branch, so that compilers can
/// vectorise it.
inline double exponential(double a) {
  const double t = a / 64.0;
  double root = 1.0 / 40320.0 + t * (1.0 / 362880.0);
  root = 1.0 / 5040.0 + t * root;
  root = 1.0 / 720.0 + t * root;
  root = 1.0 / 120.0 + t * root;
  root = 1.0 / 24.0 + t * root;
  root = 1.0 / 6.0 + t * root;
  root = 0.5 + t * root;
  root = 1.0 + t * (1.0 + t * root);
  const double p2 = root * root, p4 = p2 * p2, p8 = p4 * p4, p16 = p8 * p8, p32 = p16 * p16;
  return p32 * p32;
}

/// The points as one array per quantity, so that Eigen can vectorise: about ten landmarks are
/// computed per scan.
struct Points {
  explicit Points(const std::vector<WeightedPoint>& points)
      : x_m(points.size()), y_m(points.size()), weight(points.size()) {
    for (Eigen::Index i = 0; i < x_m.size(); ++i) {
      const WeightedPoint& point = points[static_cast<std::size_t>(i)];
      x_m[i] = point.p_map.x();
      y_m[i] = point.p_map.y();
      weight[i] = point.weight;
    }
  }

  /// Weights of the points times a Gaussian kernel at `centre`.
  void kernel_weights(const Eigen::Vector2d& centre, double kernel_m, Eigen::ArrayXd& out) const {
    constexpr double kMin = -30.0;  // derived: above 0, so that far points still attract
    const double scale = -0.5 / (kernel_m * kernel_m);
    out = (((x_m - centre.x()).square() + (y_m - centre.y()).square()) * scale).max(kMin);
    for (double& a : out) a = exponential(a);
    out *= weight;
  }

  Eigen::ArrayXd x_m, y_m, weight;
};

}  // namespace

PositionMode position_mode(const std::vector<WeightedPoint>& points,
                           const Eigen::Vector2d& start_map, double kernel_m) {
  const Points all(points);
  Eigen::ArrayXd weights(all.weight.size());
  Eigen::Vector2d centre = start_map;
  double sum = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    all.kernel_weights(centre, kernel_m * std::max(1.0, 4.0 - 0.5 * round), weights);
    sum = weights.sum();
    centre = Eigen::Vector2d((weights * all.x_m).sum(), (weights * all.y_m).sum()) / sum;
  }
  if (points.size() == 1) {
    return {centre, Eigen::Matrix2d::Identity() / points.front().weight};
  }
  const double effective = std::max(1.0, sum * sum / weights.square().sum());
  all.kernel_weights(centre, kernel_m, weights);
  const Eigen::ArrayXd dx_m = all.x_m - centre.x(), dy_m = all.y_m - centre.y();
  const double xy = (weights * dx_m * dy_m).sum();
  Eigen::Matrix2d scatter;
  scatter << (weights * dx_m.square()).sum(), xy, xy, (weights * dy_m.square()).sum();
  scatter /= sum * std::max(1.0, effective - 1.0);
  return {centre, scatter};
}

Eigen::Matrix2d scatter_around(const Eigen::Vector2d& centre_map,
                               const std::vector<WeightedPoint>& points) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  double weight = 0.0;
  for (const WeightedPoint& point : points) {
    const Eigen::Vector2d away_m = point.p_map - centre_map;
    sum += point.weight * away_m * away_m.transpose();
    weight += point.weight;
  }
  return sum / weight;
}

}  // namespace orchard::mapping
