// SPDX-License-Identifier: BSD-3-Clause
#include "laser/circle_fit.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/angles.hpp"
#include "laser/tuning.hpp"

namespace orchard::laser {
namespace {

/// derived: Gauss-Newton settles in 3 to 8 steps; a fit that needs more oscillates.
constexpr int kMaxIterations = 20;
/// derived: a tenth of a beam's footprint at arm's length; a thinner object has no curvature.
constexpr double kMinRadius_m = 1e-3;

/// Centre in polar coordinates about the laser, and radius.
struct Circle {
  double range_m, bearing_rad, radius_m;
};

/// The normal equations of one Gauss-Newton step.
struct Normal {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< upper triangle
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double chi2 = 0.0;
  int count = 0;

  void add(double residual, const Eigen::Vector3d& jacobian, double variance) {
    const double squared = residual * residual;
    double weight = 1.0 / variance;
    if (squared > tuning::kHuber * tuning::kHuber * variance)
      weight *= tuning::kHuber * std::sqrt(variance / squared);
    const Eigen::Vector3d weighted = weight * jacobian;
    for (int row = 0; row < 3; ++row) {
      for (int col = row; col < 3; ++col) information(row, col) += weighted[row] * jacobian[col];
    }
    gradient += residual * weighted;
    chi2 += weight * squared;
    ++count;
  }
};

/// derived: beams computed at once (lanes of a SIMD register).
constexpr Eigen::Index kLanes = 2;
using Lanes = Eigen::Array<double, kLanes, 1>;

/// Accumulates the beams' terms of the normal equations, one sum per lane.
class RangeSums {
 public:
  RangeSums(const Circle& c, double step_rad, double range_sd_m)
      : c_(c),
        centre_c_(std::cos(c.bearing_rad)),
        centre_s_(std::sin(c.bearing_rad)),
        min_half_chord2_m2_(tuning::kGrazingCosine * tuning::kGrazingCosine * c.radius_m *
                            c.radius_m),
        weight_by_half_chord_(1.0 / (c.radius_m * (tuning::kSteepCosine - tuning::kGrazingCosine))),
        quarter_step_rad_(0.25 * step_rad),
        range_var_m2_(range_sd_m * range_sd_m) {
    for (Lanes& sum : sums_) sum.setZero();
  }

  /// `valid` is 1 for each lane that holds a beam, else 0.
  void add(const Lanes& ranges_m, const Lanes& cosines, const Lanes& sines, const Lanes& valid) {
    // Cosine and sine of each beam's bearing relative to the centre, by the addition theorem.
    const Lanes cosine = cosines * centre_c_ + sines * centre_s_;
    const Lanes sine = sines * centre_c_ - cosines * centre_s_;
    const Lanes across_m = c_.range_m * sine;
    const Lanes half_chord2_m2 = c_.radius_m * c_.radius_m - across_m * across_m;
    // Beams that graze or miss the circle have no weight.
    const Lanes half_chord_m = half_chord2_m2.max(min_half_chord2_m2_).sqrt();
    const Lanes fraction =
        valid * (half_chord_m * weight_by_half_chord_ - kFromWeight).max(0.0).min(1.0);
    const Lanes inverse = 1.0 / half_chord_m;
    const Lanes slope = across_m * inverse;
    const Lanes by_bearing = c_.range_m * (sine - slope * cosine);
    const Lanes by_range = cosine + slope * sine;
    const Lanes by_radius = -c_.radius_m * inverse;
    const Lanes residual = ranges_m - (c_.range_m * cosine - half_chord_m);
    // The footprint is about one beam step wide; the reading lies anywhere within it.
    const Lanes spread_m = by_bearing * quarter_step_rad_;
    const Lanes variance = range_var_m2_ + spread_m * spread_m;
    const Lanes squared = residual * residual;
    const Lanes least = tuning::kHuber * tuning::kHuber * variance;
    Lanes weight = fraction;
    // The root of one is one, and few beams are outliers.
    if (squared[0] > least[0] || squared[1] > least[1]) {
      weight *= (least / squared.max(least)).sqrt();
    }
    weight /= variance;
    const Lanes weighted_range = weight * by_range, weighted_bearing = weight * by_bearing;
    const Lanes weighted_radius = weight * by_radius;
    sums_[0] += weighted_range * by_range;
    sums_[1] += weighted_range * by_bearing;
    sums_[2] += weighted_range * by_radius;
    sums_[3] += weighted_bearing * by_bearing;
    sums_[4] += weighted_bearing * by_radius;
    sums_[5] += weighted_radius * by_radius;
    sums_[6] += weighted_range * residual;
    sums_[7] += weighted_bearing * residual;
    sums_[8] += weighted_radius * residual;
    sums_[9] += weight * squared;
    for (Eigen::Index lane = 0; lane < kLanes; ++lane) count_ += fraction[lane] > 1e-12 ? 1 : 0;
  }

  Normal normal() const {
    Normal sum;
    sum.information << sums_[0].sum(), sums_[1].sum(), sums_[2].sum(),  //
        0.0, sums_[3].sum(), sums_[4].sum(),                            //
        0.0, 0.0, sums_[5].sum();
    sum.gradient << sums_[6].sum(), sums_[7].sum(), sums_[8].sum();
    sum.chi2 = sums_[9].sum();
    sum.count = count_;
    return sum;
  }

 private:
  // derived: the weight is 0 at kGrazingCosine.
  static constexpr double kFromWeight =
      tuning::kGrazingCosine / (tuning::kSteepCosine - tuning::kGrazingCosine);

  Circle c_;
  double centre_c_, centre_s_;
  double min_half_chord2_m2_, weight_by_half_chord_;
  double quarter_step_rad_, range_var_m2_;
  std::array<Lanes, 10> sums_;
  int count_ = 0;
};

Normal normal_of_ranges(const Arc& arc, const Circle& c, double step_rad, double range_sd_m) {
  RangeSums sums(c, step_rad, range_sd_m);
  const Eigen::Index n = static_cast<Eigen::Index>(arc.ranges_m.size());
  const auto lanes = [](const std::vector<double>& values, Eigen::Index from) {
    return Eigen::Map<const Lanes>(values.data() + from);
  };
  Eigen::Index i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    sums.add(lanes(arc.ranges_m, i), lanes(arc.cosines, i), lanes(arc.sines, i), Lanes::Ones());
  }
  if (i == n) return sums.normal();
  Lanes ranges_m = Lanes::Ones(), cosines = Lanes::Ones(), sines = Lanes::Zero();
  Lanes valid = Lanes::Zero();
  for (Eigen::Index lane = 0; i < n; ++i, ++lane) {
    const std::size_t k = static_cast<std::size_t>(i);
    ranges_m[lane] = arc.ranges_m[k];
    cosines[lane] = arc.cosines[k];
    sines[lane] = arc.sines[k];
    valid[lane] = 1.0;
  }
  sums.add(ranges_m, cosines, sines, valid);
  return sums.normal();
}

void add_sides(const Arc& arc, const Circle& c, Normal& sum) {
  const double sine = std::min(c.radius_m / c.range_m, 0.999);
  const double half_rad = std::asin(sine);
  const double slope = 1.0 / std::sqrt(1.0 - sine * sine);
  const double by_radius = slope / c.range_m;
  const double by_range = -slope * sine / c.range_m;
  if (arc.low_side_sd_rad > 0.0) {
    sum.add(arc.low_side_rad - (c.bearing_rad - half_rad), {-by_range, 1.0, -by_radius},
            arc.low_side_sd_rad * arc.low_side_sd_rad);
  }
  if (arc.high_side_sd_rad > 0.0) {
    sum.add(arc.high_side_rad - (c.bearing_rad + half_rad), {by_range, 1.0, by_radius},
            arc.high_side_sd_rad * arc.high_side_sd_rad);
  }
}

Normal normal_at(const Arc& arc, const Circle& c, double step_rad, double range_sd_m,
                 const std::optional<RadiusPrior>& prior) {
  Normal sum = normal_of_ranges(arc, c, step_rad, range_sd_m);
  add_sides(arc, c, sum);
  if (prior) sum.add(prior->mean_m - c.radius_m, {0.0, 0.0, 1.0}, prior->sd_m * prior->sd_m);
  return sum;
}

/// Initial circle: assumes that the arc shows the whole visible half of the circle.
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

bool is_hopeless(const Normal& normal, int step) {
  if (step < tuning::kStepsToJudge) return false;
  const std::size_t k = std::min<std::size_t>(
      static_cast<std::size_t>(step - tuning::kStepsToJudge), tuning::kHopeless.size() - 1);
  return normal.chi2 > tuning::kHopeless[k] * tuning::kGoodFit * (normal.count - 3);
}

Circle polar(const CircleFit& fit) {
  return {std::hypot(fit.x_m, fit.y_m), std::atan2(fit.y_m, fit.x_m), fit.radius_m};
}

}  // namespace

std::optional<CircleFit> fit_circle(const Arc& arc, double bearing_step_rad, double range_sd_m,
                                    double radius_max_m, const CircleSearch& search) {
  if (arc.ranges_m.empty()) return std::nullopt;
  Circle c = search.near ? polar(*search.near) : first_guess(arc);
  Normal normal;
  Eigen::Matrix3d inverse;
  bool settled = false;
  Eigen::Vector3d last_step = Eigen::Vector3d::Zero();
  double trust = 1.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    normal = normal_at(arc, c, bearing_step_rad, range_sd_m, search.prior);
    if (normal.count < 3) return std::nullopt;
    if (search.only_good && is_hopeless(normal, i)) return std::nullopt;
    bool invertible = false;
    normal.information.triangularView<Eigen::StrictlyLower>() =
        normal.information.transpose().triangularView<Eigen::StrictlyLower>();
    normal.information.computeInverseWithCheck(inverse, invertible, 1e-12);
    if (!invertible) return std::nullopt;
    if (settled) break;
    const Eigen::Vector3d step = inverse * normal.gradient;
    // At most half a radius per step: beyond that too few beams constrain the circle.
    const double largest_m =
        std::max({std::abs(step.x()), std::abs(step.y()) * c.range_m, std::abs(step.z())});
    // Halve from a reversed step on: the weights change with the circle, so full steps oscillate.
    if (step.dot(last_step) < 0.0) trust *= 0.5;
    const double damping = std::min(trust, 0.5 * c.radius_m / std::max(largest_m, 1e-12));
    last_step = step;
    c.range_m += damping * step.x();
    c.bearing_rad += damping * step.y();
    c.radius_m += damping * step.z();
    if (!(c.radius_m > kMinRadius_m) || !(c.radius_m < radius_max_m) || !(c.range_m > c.radius_m)) {
      return std::nullopt;
    }
    settled = largest_m < search.settled_m;
    if (search.only_good && i >= tuning::kStepsToSettleDown && largest_m > tuning::kRestless_m)
      return std::nullopt;
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

double line_chi2(const Arc& arc, double range_sd_m) {
  // A line is 1 / range = a cos + b sin; sd(1 / range) = sd(range) / range^2.
  double cc = 0.0, cs = 0.0, ss = 0.0, cy = 0.0, sy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
    const double weight = arc.ranges_m[i] * arc.ranges_m[i] / range_sd_m;
    const double c = weight * arc.cosines[i];
    const double s = weight * arc.sines[i];
    const double y = arc.ranges_m[i] / range_sd_m;
    cc += c * c;
    cs += c * s;
    ss += s * s;
    cy += c * y;
    sy += s * y;
    yy += y * y;
  }
  const double determinant = cc * ss - cs * cs;
  if (!(determinant > 0.0)) return 0.0;
  const double a = (cy * ss - sy * cs) / determinant, b = (sy * cc - cy * cs) / determinant;
  return std::max(0.0, yy - a * cy - b * sy);
}

}  // namespace orchard::laser
