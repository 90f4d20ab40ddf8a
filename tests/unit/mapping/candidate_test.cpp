// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/candidate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "unit/central_difference.hpp"

namespace orchard::mapping {
namespace {

pose::PoseEstimate some_pose() {
  pose::PoseEstimate pose;
  pose.x_m = 3.0;
  pose.y_m = -2.0;
  pose.yaw_rad = 2.5;
  pose.covariance = {0.04, 0.01, -0.003, 0.03, 0.002, 0.01};
  return pose;
}

detection::Detection at(double x_m, double y_m) {
  detection::Detection d;
  d.centre_x_m = x_m;
  d.centre_y_m = y_m;
  d.covariance = {4e-4, 1e-4, 9e-4};
  return d;
}

TEST(Candidate, CovarianceIsThatOfTheCentralDifferences) {
  const pose::PoseEstimate pose = some_pose();
  detection::Detections seen;
  seen.trunks = {at(2.0, 1.0)};
  const auto candidates = compose(seen, pose, PoseComposition(pose), 10.0);
  ASSERT_EQ(candidates.size(), 1u);
  // A centre in map by the pose and by itself.
  Eigen::VectorXd x(5);
  x << pose.x_m, pose.y_m, pose.yaw_rad, 2.0, 1.0;
  const auto place = [](const Eigen::VectorXd& v) {
    return geometry::transform(Eigen::Vector3d(v.head<3>()), Eigen::Vector2d(v.tail<2>()));
  };
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(5, 5);
  P.topLeftCorner<3, 3>() << 0.04, 0.01, -0.003, 0.01, 0.03, 0.002, -0.003, 0.002, 0.01;
  P.bottomRightCorner<2, 2>() << 4e-4, 1e-4, 1e-4, 9e-4;
  const Eigen::MatrixXd J = orchard::test::central_difference(place, x).J;
  const Eigen::Matrix2d expected =
      J * P * J.transpose() + 1e-6 * Eigen::Matrix2d::Identity();  // at least a millimetre
  EXPECT_LT((candidates[0].p_map - place(x)).norm(), 1e-12);
  EXPECT_LT((candidates[0].covariance - expected).norm(), 1e-8 * expected.norm());
}

TEST(Candidate, FarOnesAndThoseWithoutAPlaceAreLeftOut) {
  const pose::PoseEstimate pose = some_pose();
  detection::Detections seen;
  seen.trunks = {at(2.0, 1.0), at(9.0, 5.0), at(std::nan(""), 1.0), at(1.0, 1.0)};
  const auto candidates = compose(seen, pose, PoseComposition(pose), 10.0);
  ASSERT_EQ(candidates.size(), 2u);
  EXPECT_EQ(candidates[1].detection, &seen.trunks[3]);
}

using Points = std::vector<Eigen::Vector2d>;

constexpr double kKernel_m = 0.15;
constexpr double kShiftSd_m = 0.1;
constexpr double kYawSd_rad = 0.1;

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  Eigen::Vector2d in_square(double half_m) {
    const double x_m = uniform(-half_m, half_m);
    return {x_m, uniform(-half_m, half_m)};
  }

 private:
  std::mt19937_64 bits_;
};

NearestLandmark nearest_of(const Points& landmarks) {
  return [&landmarks](const Eigen::Vector2d& p, double reach_m) -> std::optional<Eigen::Vector2d> {
    std::optional<Eigen::Vector2d> best;
    for (const Eigen::Vector2d& l : landmarks) {
      if ((l - p).norm() < (best ? (*best - p).norm() : reach_m)) best = l;
    }
    return best;
  };
}

Eigen::Matrix3d prior() {
  return Eigen::Vector3d(kShiftSd_m * kShiftSd_m, kShiftSd_m * kShiftSd_m, kYawSd_rad * kYawSd_rad)
      .asDiagonal();
}

/// Two rows 4 m apart with a tree every 3 m or so, and a scan of them from a pose that is wrong.
struct Situation {
  Situation(std::uint64_t seed, double clutter_fraction) {
    Random random(seed);
    robot_map = random.in_square(0.5);
    error << random.uniform(-kShiftSd_m, kShiftSd_m), random.uniform(-kShiftSd_m, kShiftSd_m),
        random.uniform(-0.25, 0.25);
    const Eigen::Rotation2Dd back(-error.z());
    for (int tree = -2; tree <= 3; ++tree) {
      for (const double row_m : {-2.0, 2.0}) {
        landmarks.push_back(Eigen::Vector2d(3.0 * tree - 1.5, row_m) + random.in_square(0.3));
        const Eigen::Vector2d p =
            robot_map + back * (landmarks.back() - robot_map - error.head<2>());
        scan.push_back({p + random.in_square(0.005), 0.01});
      }
    }
    const auto num_clutter = static_cast<int>(clutter_fraction / (1.0 - clutter_fraction) *
                                              static_cast<double>(scan.size()));
    for (int k = 0; k < num_clutter; ++k) scan.push_back({random.in_square(8.0), 0.01});
  }

  ScanAlignment align() const {
    return align_scan(scan, robot_map, prior(), kKernel_m, nearest_of(landmarks));
  }

  Eigen::Vector2d robot_map;
  Eigen::Vector3d error;  ///< true pose less the claimed one: what the alignment should find
  Points landmarks;
  std::vector<AlignmentPoint> scan;
};

int num_recovered(double clutter_fraction) {
  int recovered = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Situation s(seed, clutter_fraction);
    const Eigen::Vector3d left = s.align().x_y_yaw - s.error;
    if (left.head<2>().norm() < 0.01 && std::abs(left.z()) < geometry::kPi / 360.0) ++recovered;
  }
  return recovered;
}

TEST(ScanAlignment, FindsAWrongPose) { EXPECT_GE(num_recovered(0.0), 190); }

TEST(ScanAlignment, FindsAWrongPoseAmongClutter) { EXPECT_GE(num_recovered(0.4), 190); }

TEST(ScanAlignment, KnowsBetterAfterwards) {
  const ScanAlignment alignment = Situation(5, 0.0).align();
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(alignment.covariance(i, i), 0.0);
    EXPECT_LT(alignment.covariance(i, i), 0.5 * prior()(i, i));
  }
}

void expect_untouched(const ScanAlignment& alignment) {
  EXPECT_EQ(alignment.x_y_yaw, Eigen::Vector3d::Zero().eval());
  EXPECT_EQ(alignment.covariance, prior());
}

TEST(ScanAlignment, LeavesThePoseWhereNothingMatches) {
  Situation s(3, 0.0);
  for (Eigen::Vector2d& l : s.landmarks) l.x() += 500.0;
  expect_untouched(s.align());
  s.landmarks.clear();
  expect_untouched(s.align());
}

TEST(ScanAlignment, OneTreeIsNotEnough) {
  Situation s(3, 0.0);
  s.landmarks.resize(1);
  expect_untouched(s.align());
  s.scan.resize(1);
  expect_untouched(s.align());
  s.scan.clear();
  expect_untouched(s.align());
}

TEST(ScanAlignment, AppliesTheTurnAboutTheRobot) {
  ScanAlignment alignment;
  alignment.x_y_yaw << 0.1, -0.2, 0.5 * geometry::kPi;
  const Eigen::Vector2d p = alignment.apply({3.0, 1.0}, {2.0, 1.0});
  EXPECT_NEAR(p.x(), 2.1, 1e-12);
  EXPECT_NEAR(p.y(), 1.8, 1e-12);
}

}  // namespace

}  // namespace orchard::mapping
