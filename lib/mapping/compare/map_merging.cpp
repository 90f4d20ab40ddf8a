// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_merging.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mapping/compare/local_deformation.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Lower limit of a map's position error [m], regardless of its standard errors.
constexpr double kFloor_m = 0.01;
/// Scatter of one observation, used if there is no standard error [m].
constexpr double kOneObservation_m = 0.03;

/// Inverse of eq. 13: sum of squares about the mean from the standard error.
double sum_of_squares(double se_m, int n) { return se_m * se_m * n * (n - 1.0); }

double pooled_se(double se_a, int n_a, double se_b, int n_b, double difference_m) {
  const double n = static_cast<double>(n_a) + n_b;
  if (n < 2.0) return 0.0;
  const double sum = sum_of_squares(se_a, n_a) + sum_of_squares(se_b, n_b) +
                     (n_a > 0 && n_b > 0 ? difference_m * difference_m * n_a * n_b / n : 0.0);
  return std::sqrt(sum / (n * (n - 1.0)));
}

/// Position covariance: as stored in the map, else from the standard errors.
Matrix2d covariance_of(const Landmark& l) {
  Matrix2d c;
  c << l.covariance[0], l.covariance[1], l.covariance[1], l.covariance[2];
  if (!(c.determinant() > 0.0)) {
    const double one_m = kOneObservation_m / std::sqrt(std::max(1, l.num_observations));
    const double x_m = l.se_x_m > 0.0 ? l.se_x_m : one_m, y_m = l.se_y_m > 0.0 ? l.se_y_m : one_m;
    c << x_m * x_m, 0.0, 0.0, y_m * y_m;
  }
  return c + Matrix2d::Identity() * kFloor_m * kFloor_m;
}

double log_odds(double probability) {
  const double p = std::clamp(probability, 1e-4, 1.0 - 1e-4);  // files have four digits
  return std::log(p / (1.0 - p));
}

}  // namespace

Landmark transformed(const Landmark& b, const geometry::Pose2& T_a_b) {
  Landmark l = b;
  const Matrix2d R = rotation(T_a_b);
  const Vector2d p = transform(T_a_b, {b.x_m, b.y_m});
  l.x_m = p.x();
  l.y_m = p.y();
  Matrix2d errors = Matrix2d::Zero();
  errors(0, 0) = b.se_x_m * b.se_x_m;
  errors(1, 1) = b.se_y_m * b.se_y_m;
  errors = R * errors * R.transpose();
  l.se_x_m = std::sqrt(errors(0, 0));
  l.se_y_m = std::sqrt(errors(1, 1));
  Matrix2d c;
  c << b.covariance[0], b.covariance[1], b.covariance[1], b.covariance[2];
  c = R * c * R.transpose();
  l.covariance = {c(0, 0), c(0, 1), c(1, 1)};
  return l;
}

Landmark merged_landmark(const Landmark& a, const Landmark& b) {
  Landmark l = a;
  const int n_a = a.num_observations, n_b = b.num_observations;
  const double n = static_cast<double>(n_a) + n_b;
  l.num_observations = n_a + n_b;
  if (n > 0.0) l.roc_mean = (n_a * a.roc_mean + n_b * b.roc_mean) / n;
  l.se_x_m = pooled_se(a.se_x_m, n_a, b.se_x_m, n_b, b.x_m - a.x_m);
  l.se_y_m = pooled_se(a.se_y_m, n_a, b.se_y_m, n_b, b.y_m - a.y_m);
  const Matrix2d information_a = covariance_of(a).inverse();
  const Matrix2d information_b = covariance_of(b).inverse();
  const Matrix2d covariance = (information_a + information_b).inverse();
  const Vector2d p = covariance * (information_a * Vector2d(a.x_m, a.y_m) +
                                   information_b * Vector2d(b.x_m, b.y_m));
  l.x_m = p.x();
  l.y_m = p.y();
  l.covariance = {covariance(0, 0), covariance(0, 1), covariance(1, 1)};
  double weight_a = std::max(1, n_a), weight_b = std::max(1, n_b);
  if (a.width_sd_m > 0.0 && b.width_sd_m > 0.0) {
    weight_a = 1.0 / (a.width_sd_m * a.width_sd_m);
    weight_b = 1.0 / (b.width_sd_m * b.width_sd_m);
    l.width_sd_m = 1.0 / std::sqrt(weight_a + weight_b);
  } else {
    l.width_sd_m = 0.0;
  }
  l.width_m = (weight_a * a.width_m + weight_b * b.width_m) / (weight_a + weight_b);
  if (a.label == Label::kUnseen || b.label == Label::kUnseen) {
    const Landmark& judged = a.label == Label::kUnseen ? b : a;
    l.label = judged.label;
    l.probability = judged.probability;
  } else {
    const double odds = log_odds(a.probability) + log_odds(b.probability);
    l.probability = 1.0 / (1.0 + std::exp(-odds));
    if (a.label != b.label) l.label = odds > 0.0 ? Label::kTree : Label::kObject;
  }
  return l;
}

std::vector<MergedId> merge_into(MergedMap& merged, const std::vector<Landmark>& b,
                                 const MapAlignment& alignment) {
  std::vector<Vector2d> places_a, places_b;
  for (const Landmark& l : merged.landmarks) {
    places_a.push_back({l.x_m, l.y_m});
    merged.next_id = std::max(merged.next_id, l.id + 1);
  }
  for (const Landmark& l : b) places_b.push_back({l.x_m, l.y_m});
  const geometry::IndexedPoints a_points(std::move(places_a)), b_points(std::move(places_b));
  // Pair after local alignment, so that deformation does not duplicate a tree.
  const geometry::IndexedPoints b_in_a(without_local_deformation(a_points, b_points, alignment));
  const double gate_m = std::clamp(0.35 * geometry::typical_spacing_m(a_points), 0.1, 0.5);
  std::vector<std::int32_t> partner(b.size(), -1);
  for (const LandmarkPair& pair : pair_landmarks(a_points, b_in_a, geometry::Pose2{}, gate_m)) {
    partner[static_cast<std::size_t>(pair.b)] = pair.a;
  }
  std::vector<std::size_t> order(b.size());
  for (std::size_t j = 0; j < order.size(); ++j) order[j] = j;
  std::sort(order.begin(), order.end(),
            [&](std::size_t x, std::size_t y) { return b[x].id < b[y].id; });
  std::vector<MergedId> ids(b.size());
  for (const std::size_t j : order) {
    Landmark l = transformed(b[j], alignment.T_a_b);
    l.x_m = b_in_a[j].x();
    l.y_m = b_in_a[j].y();
    if (partner[j] >= 0) {
      Landmark& known = merged.landmarks[static_cast<std::size_t>(partner[j])];
      known = merged_landmark(known, l);
      ids[j] = {b[j].id, known.id};
    } else {
      l.id = merged.next_id++;
      l.row = l.position = 0;
      merged.landmarks.push_back(l);
      ids[j] = {b[j].id, l.id};
    }
  }
  return ids;
}

}  // namespace orchard::mapping
