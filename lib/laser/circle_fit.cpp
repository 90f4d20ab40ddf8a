// SPDX-License-Identifier: BSD-3-Clause
#include "laser/circle_fit.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::laser {
namespace {

constexpr int kMaxIterations = 12;
constexpr double kSmallestRadius_m = 1e-3;
/// Beams that meet the surface flatter than this say little of range; the sides say it better.
/// Their weight falls between these two, so that no beam comes and goes as the circle settles.
constexpr double kGrazingCosine = 0.2;
constexpr double kSteepCosine = 0.4;
/// Residuals beyond this many sigmas weigh less.
constexpr double kHuber = 2.5;

/// Centre in polar coordinates about the laser, and radius.
struct Circle {
  double range_m, bearing_rad, radius_m;
};

/// The normal equations of one Gauss-Newton step.
struct Normal {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double chi2 = 0.0;
  int count = 0;

  void add(double residual, const Eigen::Vector3d& jacobian, double sd, double share = 1.0) {
    const double sigmas = std::abs(residual) / sd;
    const double weight = share * (sigmas <= kHuber ? 1.0 : kHuber / sigmas) / (sd * sd);
    information += weight * jacobian * jacobian.transpose();
    gradient += weight * residual * jacobian;
    chi2 += weight * residual * residual;
    ++count;
  }
};

/// Cosine and sine of a beam's bearing.
struct Direction {
  double c, s;
};

void add_ranges(const Arc& arc, const std::vector<Direction>& beams, const Circle& c,
                double step_rad, double range_sd_m, Normal& sum) {
  const double radius2_m2 = c.radius_m * c.radius_m;
  const double centre_c = std::cos(c.bearing_rad), centre_s = std::sin(c.bearing_rad);
  for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
    // of the beam's bearing from the centre's, without two more functions per beam and step
    const double cosine = beams[i].c * centre_c + beams[i].s * centre_s;
    const double sine = beams[i].s * centre_c - beams[i].c * centre_s;
    const double across_m = c.range_m * sine;
    const double half_chord2_m2 = radius2_m2 - across_m * across_m;
    if (half_chord2_m2 <= kGrazingCosine * kGrazingCosine * radius2_m2) continue;
    const double half_chord_m = std::sqrt(half_chord2_m2);
    const double share = std::min(
        1.0, (half_chord_m / c.radius_m - kGrazingCosine) / (kSteepCosine - kGrazingCosine));
    const double expected_m = c.range_m * cosine - half_chord_m;
    const double by_bearing = -c.range_m * sine + c.range_m * across_m * cosine / half_chord_m;
    const Eigen::Vector3d jacobian(cosine + across_m * sine / half_chord_m, -by_bearing,
                                   -c.radius_m / half_chord_m);
    // the spot is about a step wide, and what it reads lies somewhere in it
    const double spread_m = by_bearing * step_rad * 0.25;
    const double sd_m = std::sqrt(range_sd_m * range_sd_m + spread_m * spread_m);
    sum.add(arc.ranges_m[i] - expected_m, jacobian, sd_m, share);
  }
}

void add_sides(const Arc& arc, const Circle& c, Normal& sum) {
  const double sine = std::min(c.radius_m / c.range_m, 0.999);
  const double half_rad = std::asin(sine);
  const double slope = 1.0 / std::sqrt(1.0 - sine * sine);
  const double by_radius = slope / c.range_m;
  const double by_range = -slope * sine / c.range_m;
  if (arc.low_side_sd_rad > 0.0) {
    sum.add(arc.low_side_rad - (c.bearing_rad - half_rad), {-by_range, 1.0, -by_radius},
            arc.low_side_sd_rad);
  }
  if (arc.high_side_sd_rad > 0.0) {
    sum.add(arc.high_side_rad - (c.bearing_rad + half_rad), {by_range, 1.0, by_radius},
            arc.high_side_sd_rad);
  }
}

Normal normal_at(const Arc& arc, const std::vector<Direction>& beams, const Circle& c,
                 double step_rad, double range_sd_m) {
  Normal sum;
  add_ranges(arc, beams, c, step_rad, range_sd_m, sum);
  add_sides(arc, c, sum);
  return sum;
}

/// As if the arc were the whole of the circle.
Circle first_guess(const Arc& arc) {
  double mean_m = 0.0;
  for (const double range_m : arc.ranges_m) mean_m += range_m;
  mean_m /= static_cast<double>(arc.ranges_m.size());
  const double half_rad =
      std::clamp(0.5 * (arc.high_side_rad - arc.low_side_rad), 1e-5, 0.45 * geometry::kPi);
  const double sine = std::sin(half_rad);
  const double radius_m = mean_m * sine / (1.0 - 0.25 * geometry::kPi * sine);
  return {mean_m + 0.25 * geometry::kPi * radius_m, 0.5 * (arc.low_side_rad + arc.high_side_rad),
          radius_m};
}

}  // namespace

std::optional<CircleFit> fit_circle(const Arc& arc, double bearing_step_rad, double range_sd_m,
                                    double radius_max_m) {
  if (arc.ranges_m.empty()) return std::nullopt;
  std::vector<Direction> beams;
  beams.reserve(arc.bearings_rad.size());
  for (const double bearing_rad : arc.bearings_rad) {
    beams.push_back({std::cos(bearing_rad), std::sin(bearing_rad)});
  }
  Circle c = first_guess(arc);
  Normal normal;
  Eigen::Matrix3d inverse;
  bool settled = false;
  Eigen::Vector3d last_step = Eigen::Vector3d::Zero();
  for (int i = 0; i < kMaxIterations; ++i) {
    normal = normal_at(arc, beams, c, bearing_step_rad, range_sd_m);
    if (normal.count < 3) return std::nullopt;
    bool invertible = false;
    normal.information.computeInverseWithCheck(inverse, invertible, 1e-12);
    if (!invertible) return std::nullopt;
    if (settled) break;
    const Eigen::Vector3d step = inverse * normal.gradient;
    // half a radius at most: a far step would leave the beams behind that must steer it
    const double largest_m =
        std::max({std::abs(step.x()), std::abs(step.y()) * c.range_m, std::abs(step.z())});
    double damping = std::min(1.0, 0.5 * c.radius_m / std::max(largest_m, 1e-12));
    // a step back: as weights follow the circle, whole steps go to and fro about where it settles
    if (step.dot(last_step) < 0.0) damping *= 0.5;
    last_step = step;
    c.range_m += damping * step.x();
    c.bearing_rad += damping * step.y();
    c.radius_m += damping * step.z();
    if (!(c.radius_m > kSmallestRadius_m) || !(c.radius_m < radius_max_m) ||
        !(c.range_m > c.radius_m)) {
      return std::nullopt;
    }
    settled = largest_m < 1e-5;
  }
  if (!settled) return std::nullopt;

  CircleFit fit;
  const double cosine = std::cos(c.bearing_rad), sine = std::sin(c.bearing_rad);
  fit.x_m = c.range_m * cosine;
  fit.y_m = c.range_m * sine;
  fit.radius_m = c.radius_m;
  fit.chi2 = normal.chi2;
  fit.dof = normal.count - 3;
  Eigen::Matrix3d to_plane;
  to_plane << cosine, -fit.y_m, 0.0, sine, fit.x_m, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d covariance =
      std::max(1.0, fit.chi2_per_dof()) * to_plane * inverse * to_plane.transpose();
  fit.covariance = {covariance(0, 0), covariance(0, 1), covariance(1, 1),
                    covariance(0, 2), covariance(1, 2), covariance(2, 2)};
  return fit;
}

}  // namespace orchard::laser
