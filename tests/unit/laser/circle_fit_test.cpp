// SPDX-License-Identifier: BSD-3-Clause
#include "laser/circle_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "laser/segment.hpp"
#include "unit/central_difference.hpp"
#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

using test::Disc;
using test::hit_m;
using test::Noise;
using test::noise_of;
using test::noisy_scan;
using test::Scanner;
using test::screen;
using test::Things;
using test::urg;

constexpr double kStep_rad = 0.0025, kRangeSd_m = 0.008, kSideSd_rad = 0.0007;

/// Beams on the disc at whole steps, up to this sine of incidence, and the tangents to its sides.
Arc arc_of(const Disc& disc, double sine_max = 1.0) {
  Arc arc;
  const double range_m = std::hypot(disc.x_m, disc.y_m);
  const double middle_rad = std::atan2(disc.y_m, disc.x_m);
  const double half_rad = std::asin(disc.radius_m / range_m);
  for (int i = -1000; i <= 1000; ++i) {
    const double bearing_rad = i * kStep_rad;
    const double off_rad = bearing_rad - middle_rad;
    if (std::abs(off_rad) >= half_rad) continue;
    if (std::abs(std::sin(off_rad)) * range_m > sine_max * disc.radius_m) continue;
    arc.ranges_m.push_back(hit_m({{disc}, {}}, bearing_rad));
    arc.cosines.push_back(std::cos(bearing_rad));
    arc.sines.push_back(std::sin(bearing_rad));
  }
  arc.low_side_rad = middle_rad - half_rad;
  arc.high_side_rad = middle_rad + half_rad;
  arc.low_side_sd_rad = arc.high_side_sd_rad = kSideSd_rad;
  return arc;
}

std::optional<CircleFit> fit(const Arc& arc, const CircleSearch& search = {}) {
  return fit_circle(arc, kStep_rad, kRangeSd_m, 1.0, search);
}

Eigen::Matrix3d covariance_of(const CircleFit& fit) {
  const auto& [xx, xy, yy, xr, yr, rr] = fit.covariance;
  return (Eigen::Matrix3d() << xx, xy, xr, xy, yy, yr, xr, yr, rr).finished();
}

const std::vector<Disc> kDiscs{{1.2, 0.0, 0.05}, {2.5, 0.9, 0.11}, {0.9, -0.6, 0.2}};

TEST(CircleFit, ExactMeasurementsGiveTheCircle) {
  for (const Disc& disc : kDiscs) {
    const auto found = fit(arc_of(disc));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->x_m, disc.x_m, 1e-5);
    EXPECT_NEAR(found->y_m, disc.y_m, 1e-5);
    EXPECT_NEAR(found->radius_m, disc.radius_m, 1e-5);
    EXPECT_LT(found->chi2, 1e-3);
  }
}

// The covariance is the inverse of the information J^T W J: J by central differences of where a ray
// meets a circle and of the tangents' bearings, W by the noise that fit_circle's comment states.
TEST(CircleFit, CovarianceIsThatOfTheCentralDifferences) {
  for (const Disc& disc : kDiscs) {
    for (const bool has_prior : {false, true}) {
      const Arc arc = arc_of(disc, 0.9);  // no grazing beam: all of full weight
      CircleSearch search;
      const double prior_sd_m = 0.004;
      if (has_prior) search.prior = RadiusPrior{disc.radius_m, prior_sd_m};
      const auto found = fit(arc, search);
      ASSERT_TRUE(found);
      const Eigen::Vector3d circle(disc.x_m, disc.y_m, disc.radius_m);
      Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
      const auto tell = [&](const auto& measurement, double variance) {
        const Eigen::MatrixXd J = orchard::test::central_difference(measurement, circle, 1e-5).J;
        information += J.transpose() * J / variance;
      };
      for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
        const double bearing_rad = std::atan2(arc.sines[i], arc.cosines[i]);
        const auto range = [&](const Eigen::VectorXd& c) {
          return Eigen::Matrix<double, 1, 1>(hit_m({{{c[0], c[1], c[2]}}, {}}, bearing_rad));
        };
        const auto by_bearing = [&](const Eigen::VectorXd& b) {
          return Eigen::Matrix<double, 1, 1>(hit_m({{disc}, {}}, b[0]));
        };
        const double slope = orchard::test::central_difference(
                                 by_bearing, Eigen::VectorXd::Constant(1, bearing_rad), 1e-6)
                                 .J(0, 0);
        tell(range, kRangeSd_m * kRangeSd_m + std::pow(0.25 * kStep_rad * slope, 2));
      }
      for (const double side : {-1.0, 1.0}) {
        tell(
            [&](const Eigen::VectorXd& c) {
              return Eigen::Matrix<double, 1, 1>(std::atan2(c[1], c[0]) +
                                                 side * std::asin(c[2] / std::hypot(c[0], c[1])));
            },
            kSideSd_rad * kSideSd_rad);
      }
      if (has_prior) information(2, 2) += 1.0 / (prior_sd_m * prior_sd_m);
      const Eigen::Matrix3d expected = information.inverse();
      EXPECT_LT((covariance_of(*found) - expected).norm(), 1e-3 * expected.norm());
      EXPECT_EQ(found->dof, static_cast<int>(arc.ranges_m.size()) + 2 + has_prior - 3);
    }
  }
}

TEST(CircleFit, AHiddenSideIsLeftOutAndWidensTheRadius) {
  const Arc whole = arc_of(kDiscs[1]);
  Arc half = whole;
  half.high_side_sd_rad = 0.0;
  const auto both = fit(whole), one = fit(half);
  ASSERT_TRUE(both && one);
  EXPECT_NEAR(one->radius_m, kDiscs[1].radius_m, 1e-5);
  EXPECT_GT(one->covariance[5], 1.5 * both->covariance[5]);
  EXPECT_EQ(one->dof, both->dof - 1);
}

TEST(CircleFit, OneOutlierMovesTheCircleLittle) {
  Arc arc = arc_of(kDiscs[1]);
  arc.ranges_m[arc.ranges_m.size() / 2] += 0.1;
  const auto found = fit(arc);
  ASSERT_TRUE(found);
  EXPECT_LT(std::hypot(found->x_m - kDiscs[1].x_m, found->y_m - kDiscs[1].y_m), 0.004);
}

TEST(CircleFit, NoiseAboveTheStatedOneWidensTheCovarianceByAsMuch) {
  Arc arc = arc_of(kDiscs[1]);
  const auto quiet = fit(arc);
  for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
    arc.ranges_m[i] += (i % 2 == 0 ? 2.0 : -2.0) * kRangeSd_m;
  }
  const auto noisy = fit(arc);
  ASSERT_TRUE(quiet && noisy);
  EXPECT_GT(noisy->chi2_per_dof(), 2.0);
  EXPECT_NEAR(noisy->covariance[5] / quiet->covariance[5], noisy->chi2_per_dof(),
              0.2 * noisy->chi2_per_dof());
}

TEST(CircleFit, NoneWithoutThreeMeasurementsOrACircleInBounds) {
  EXPECT_FALSE(fit(Arc{}));
  Arc one = arc_of(kDiscs[0]);
  one.ranges_m.resize(1);
  one.cosines.resize(1);
  one.sines.resize(1);
  one.low_side_sd_rad = 0.0;
  EXPECT_FALSE(fit(one));
  EXPECT_FALSE(fit_circle(arc_of(kDiscs[2]), kStep_rad, kRangeSd_m, 0.15));
  // A flat wall: no circle explains it.
  Arc flat = arc_of(kDiscs[1]);
  for (std::size_t i = 0; i < flat.ranges_m.size(); ++i) flat.ranges_m[i] = 2.0 / flat.cosines[i];
  CircleSearch good;
  good.only_good = true;
  EXPECT_FALSE(fit(flat, good));
}

// A tube of 170 mm as a scanner of 0.35 degrees saw it: at its border a beam gains and loses its
// weight as the circle grows and shrinks. Without a circle it passed for two tubes of 90 mm.
TEST(CircleFit, ACircleIsFoundThoughABeamAtItsBorderComesAndGoes) {
  const double step_rad = 2.0 * test::kPi / 1024.0;
  Arc arc;
  arc.ranges_m = {2.261, 2.239, 2.217, 2.218, 2.195, 2.207,
                  2.225, 2.207, 2.207, 2.235, 2.236, 2.287};
  for (std::size_t i = 0; i < arc.ranges_m.size(); ++i) {
    arc.cosines.push_back(std::cos(static_cast<double>(i) * step_rad));
    arc.sines.push_back(std::sin(static_cast<double>(i) * step_rad));
  }
  arc.low_side_rad = -0.5 * step_rad;
  arc.high_side_rad = 11.5 * step_rad;
  arc.low_side_sd_rad = step_rad / std::sqrt(12.0);
  arc.high_side_sd_rad = step_rad;  // something touches it there
  const auto circle = fit_circle(arc, step_rad, std::hypot(0.003, 0.006 * 2.261), 1.0);
  ASSERT_TRUE(circle);
  EXPECT_NEAR(circle->radius_m, 0.085, 0.01);
  EXPECT_LT(circle->chi2_per_dof(), 2.0);
}

/// Fraction of seeds whose 95 % ellipse contains the true centre.
double coverage(const Scanner& scanner, double hidden_fraction, int num_seeds, int& num_fitted) {
  int inside = 0;
  num_fitted = 0;
  for (int seed = 0; seed < num_seeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed) + 700);
    const double radius_m = 0.045 + 0.07 * noise.uniform();
    const double centre_m = 0.6 + 2.4 * noise.uniform();
    const double bearing_rad = 2.0 * noise.uniform() - 1.0;
    const Disc trunk{centre_m * std::cos(bearing_rad), centre_m * std::sin(bearing_rad), radius_m};
    Things things{{trunk}, {}};
    if (hidden_fraction > 0.0) {
      const double half_rad = std::asin(radius_m / centre_m);
      const double from_rad = bearing_rad + half_rad * (1.0 - 2.0 * hidden_fraction);
      things.walls.push_back(screen(0.5 * centre_m, from_rad, from_rad + 0.5));
    }
    for (const Segment& s :
         segment(noisy_scan(things, scanner, noise), {}, {}, noise_of(scanner))) {
      if (std::abs(s.range_m - centre_m) > 0.25 || !s.circle || s.range_m < 0.6 * centre_m)
        continue;
      const auto& [xx, xy, yy, xr, yr, rr] = s.circle->covariance;
      const double dx = s.circle->x_m - trunk.x_m, dy = s.circle->y_m - trunk.y_m;
      const double z2 = (dx * dx * yy - 2.0 * dx * dy * xy + dy * dy * xx) / (xx * yy - xy * xy);
      inside += z2 < 5.991;  // chi2 of two, 95 %
      ++num_fitted;
    }
  }
  return static_cast<double>(inside) / num_fitted;
}

// In 95 % of cases 500 draws hold the truth in 93.1 to 96.9 %. Of the nine here two are out of
// that: 98.0 % (0.0044 rad, whole trunk: stated too large), 92.6 % of 431 (0.0070 rad, hidden by
// 0.3).
TEST(CircleFit, NinetyToNinetyEightPercentOfItsEllipsesHoldTheTruth) {
  constexpr int kSeeds = 500;
  for (const Scanner& scanner : {urg(), test::field_scanner(), test::vlp16_slice()}) {
    for (const double hidden : {0.0, 0.3, 0.5}) {
      int num_fitted = 0;
      const double fraction = coverage(scanner, hidden, kSeeds, num_fitted);
      // With a hidden side the radius follows from the curvature alone, which a linear covariance
      // understates for few beams: 0.912 of 410 at 0.4 degrees.
      EXPECT_GT(fraction, hidden > 0.0 ? 0.90 : 0.92) << scanner.step_rad << " " << hidden;
      EXPECT_LT(fraction, 0.985) << scanner.step_rad << " " << hidden;
      EXPECT_GT(num_fitted, hidden > 0.0 ? kSeeds / 2 : kSeeds * 9 / 10) << hidden;
      RecordProperty("coverage", std::to_string(fraction));
      std::printf("  step %.4f rad, hidden %.1f: %.3f of %d\n", scanner.step_rad, hidden, fraction,
                  num_fitted);
    }
  }
}

}  // namespace
}  // namespace orchard::laser
