// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/attitude_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <utility>

#include "geometry/angles.hpp"
#include "unit/nees_band.hpp"

namespace orchard::pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDegree_rad = geometry::kPi / 180.0;

TEST(Attitude, TurnsAsEigenDoes) {
  const Attitude attitude{0.2, -0.35, 0.0};
  const Matrix3d wanted = (AngleAxisd(attitude.pitch_rad, Vector3d::UnitY()) *
                           AngleAxisd(attitude.roll_rad, Vector3d::UnitX()))
                              .toRotationMatrix();
  EXPECT_LT((R_level_base(attitude) - wanted).norm(), 1e-15);
  // The plane under base holds its x and y.
  const Eigen::Vector2d gradient = gradient_under(attitude);
  for (const Vector3d& axis : {Vector3d(wanted.col(0)), Vector3d(wanted.col(1))}) {
    EXPECT_NEAR(axis.z(), gradient.dot(axis.head<2>()), 1e-15);
  }
}

// A body that turns about its own z on a slope: its heading by the rotations themselves.
TEST(Attitude, TheHeadingTurnsWithTheBody) {
  const Matrix3d slope = AngleAxisd(0.3, Vector3d(0.6, 0.8, 0.0)).toRotationMatrix();
  const double step_rad = 1e-6;
  for (double turn_rad = 0.0; turn_rad < 6.0; turn_rad += 0.5) {
    const auto R = [&](double by_rad) -> Matrix3d {
      return slope * AngleAxisd(turn_rad + by_rad, Vector3d::UnitZ()).toRotationMatrix();
    };
    const auto heading_rad = [](const Matrix3d& m) { return std::atan2(m(1, 0), m(0, 0)); };
    const Matrix3d now = R(0.0);
    const Attitude attitude{std::atan2(now(2, 1), now(2, 2)), -std::asin(now(2, 0)), 0.0};
    const double wanted =
        geometry::wrap_angle_rad(heading_rad(R(step_rad)) - heading_rad(now)) / step_rad;
    EXPECT_NEAR(heading_rate_radps(attitude, 0.0, 1.0), wanted, 1e-5) << turn_rad;
  }
}

Imu stated(std::int64_t utime, double roll_rad, double pitch_rad) {
  Imu imu;
  imu.utime = utime;
  imu.has_orientation = true;
  imu.roll_rad = roll_rad;
  imu.pitch_rad = pitch_rad;
  return imu;
}

TEST(AttitudeFilter, TellsWhatTheUnitStatesBetweenItsSamples) {
  AttitudeFilter filter;
  EXPECT_FALSE(filter.at(0));
  filter.add(stated(1'000'000, 0.1, -0.2));
  filter.add(stated(1'100'000, 0.2, -0.4));
  const auto between = filter.at(1'025'000);
  ASSERT_TRUE(between);
  EXPECT_NEAR(between->roll_rad, 0.125, 1e-12);
  EXPECT_NEAR(between->pitch_rad, -0.25, 1e-12);
  EXPECT_NEAR(filter.at(1'250'000)->roll_rad, 0.2, 1e-12);
  EXPECT_FALSE(filter.at(1'400'000));  // the unit is silent
  EXPECT_FALSE(filter.at(700'000));    // before its first sample
  filter.add(stated(1'050'000, 3.0, 3.0));
  EXPECT_NEAR(filter.at(1'100'000)->roll_rad, 0.2, 1e-12);  // what is older is ignored
}

/// A drive over waves, as a unit of rates and forces and wheels measure it; the truth beside it.
class Waves {
 public:
  explicit Waves(unsigned seed) : random_(seed) {
    gyro_bias_ = {normal(0.01), normal(0.01), 0.0};
    force_bias_ = {normal(0.049), normal(0.049), 0.0};  // 5 mg
    phase_ = 3.0 * std::abs(normal(1.0));
  }
  virtual ~Waves() = default;
  virtual Matrix3d R(double t_s) const {
    return (AngleAxisd(0.4 * t_s, Vector3d::UnitZ()) *
            AngleAxisd(0.08 + 0.05 * std::sin(1.3 * t_s + phase_), Vector3d::UnitY()) *
            AngleAxisd(-0.06 + 0.06 * std::sin(0.9 * t_s), Vector3d::UnitX()))
        .toRotationMatrix();
  }
  virtual double speed_mps(double t_s) const { return 1.0 + 0.6 * std::sin(0.5 * t_s); }
  Odometry odometry(double t_s) {
    Odometry odometry;
    odometry.utime = utime(t_s);
    odometry.speed_mps = speed_mps(t_s) + normal(0.005);
    return odometry;
  }
  Imu imu(double t_s) {
    const double h_s = 1e-4;
    const Matrix3d turned = R(t_s - h_s).transpose() * R(t_s + h_s);
    const AngleAxisd by(turned);
    const Vector3d rate = by.angle() / (2 * h_s) * by.axis();
    const auto velocity = [&](double s) -> Vector3d { return R(s).col(0) * speed_mps(s); };
    const Vector3d force =
        R(t_s).transpose() *
        ((velocity(t_s + h_s) - velocity(t_s - h_s)) / (2 * h_s) + Vector3d(0.0, 0.0, 9.80665));
    Imu imu;
    imu.utime = utime(t_s);
    imu.angular_rate_variance = 1e-6;
    for (int i = 0; i < 3; ++i) {
      imu.angular_rate_radps[i] = rate[i] + gyro_bias_[i] + normal(0.001);
      imu.acceleration_mps2[i] = force[i] + force_bias_[i] + normal(0.5);  // shaken
    }
    return imu;
  }
  static std::int64_t utime(double t_s) { return 1'000'000 + std::llround(1e6 * t_s); }

 protected:
  double uniform(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  double normal(double sd) { return sd * std::normal_distribution<double>()(random_); }

 private:
  std::mt19937 random_;
  Vector3d gyro_bias_, force_bias_;
  double phase_;
};

TEST(AttitudeFilter, KnowsTheTiltFromRatesAndForcesAsWellAsItSays) {
  constexpr int kRuns = 30;
  double nees = 0.0, squares = 0.0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    Waves drive(seed);
    AttitudeFilter filter;
    double t_s = 0.0;
    for (int i = 0; i <= 6000; ++i, t_s = 0.01 * i) {
      if (i % 2 == 0) filter.add(drive.odometry(t_s));
      filter.add(drive.imu(t_s));
    }
    const auto told = filter.at(Waves::utime(60.0));
    ASSERT_TRUE(told);
    const Matrix3d R = drive.R(60.0);
    const double roll = told->roll_rad - std::atan2(R(2, 1), R(2, 2));
    const double pitch = told->pitch_rad + std::asin(R(2, 0));
    squares += (roll * roll + pitch * pitch) / (2 * kRuns);
    nees += (roll * roll + pitch * pitch) / (told->sd_rad * told->sd_rad) / kRuns;
  }
  EXPECT_LT(std::sqrt(squares), 0.5 * kDegree_rad);
  const test::NeesBand band = test::nees_band(2, kRuns);
  EXPECT_GT(nees, band.least);
  EXPECT_LT(nees, band.most);
}

/// A drive without wheels over a sloping plane, at one speed of up to 2 m/s either way.
class Turns : public Waves {
 public:
  enum class Way { kStraight, kHeadlands, kCircle };
  Turns(unsigned seed, Way way) : Waves(seed), way_(way) {
    slope_ = {normal(0.1), normal(0.1)};
    speed_mps_ = uniform(-2.0, 2.0);
  }
  double heading_rad(double t_s) const {
    if (way_ == Way::kStraight) return 0.3;
    if (way_ == Way::kCircle) return 0.4 * t_s;
    // Rows of 20 s, half turns of 6 s to the left and to the right by turns.
    const double since_s = std::fmod(t_s, 26.0);
    const double turned_rad = since_s < 20.0 ? 0.0 : (since_s - 20.0) / 6.0 * geometry::kPi;
    return std::fmod(t_s, 52.0) < 26.0 ? turned_rad : geometry::kPi - turned_rad;
  }
  Matrix3d R(double t_s) const override {
    const Vector3d up = Vector3d(-slope_.x(), -slope_.y(), 1.0).normalized();
    const double heading = heading_rad(t_s);
    const Vector3d left =
        up.cross(Vector3d(std::cos(heading), std::sin(heading), 0.0)).normalized();
    Matrix3d R;
    R << left.cross(up), left, up;
    return R * AngleAxisd(0.02 * std::sin(1.3 * t_s), Vector3d::UnitY()).toRotationMatrix() *
           AngleAxisd(0.02 * std::sin(0.9 * t_s), Vector3d::UnitX()).toRotationMatrix();
  }
  double speed_mps(double) const override { return speed_mps_; }

 private:
  Way way_;
  Eigen::Vector2d slope_;
  double speed_mps_;
};

/// The mean NEES of the tilt at a time of 30 drives without wheels.
double nees_without_wheels(Turns::Way way, int end_s) {
  double nees = 0.0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Turns drive(seed, way);
    AttitudeFilter filter;
    for (int i = 0; i <= 100 * end_s; ++i) filter.add(drive.imu(0.01 * i));
    const auto told = filter.at(Waves::utime(end_s));
    const Matrix3d R = drive.R(end_s);
    const double roll = told->roll_rad - std::atan2(R(2, 1), R(2, 2));
    const double pitch = told->pitch_rad + std::asin(R(2, 0));
    nees += (roll * roll + pitch * pitch) / (told->sd_rad * told->sd_rad) / 30;
  }
  return nees;
}

// A turn at an unknown speed pushes the robot aside as a tilt would.
TEST(AttitudeFilter, WithoutWheelsKnowsTheTiltAsWellAsItSays) {
  const test::NeesBand band = test::nees_band(2, 30);
  for (const auto& [way, end_s] : {std::pair{Turns::Way::kStraight, 60},
                                   {Turns::Way::kCircle, 60},
                                   {Turns::Way::kHeadlands, 50}}) {
    const double nees = nees_without_wheels(way, end_s);
    EXPECT_GT(nees, band.least) << static_cast<int>(way);
    EXPECT_LT(nees, band.most) << static_cast<int>(way);
  }
}

// Wheels that fall silent no longer tell the speed of a turn.
TEST(AttitudeFilter, WheelsThatFellSilentAreNotTrusted) {
  Turns drive(4, Turns::Way::kCircle);
  AttitudeFilter filter;
  Odometry stands;
  stands.utime = Waves::utime(0.0);
  filter.add(stands);
  for (int i = 0; i <= 6000; ++i) filter.add(drive.imu(0.01 * i));
  const auto told = filter.at(Waves::utime(60.0));
  const Matrix3d R = drive.R(60.0);
  EXPECT_NEAR(told->roll_rad, std::atan2(R(2, 1), R(2, 2)), 3.0 * told->sd_rad);
}

TEST(AttitudeFilter, BeginsAnewAfterWhatNoRobotMeasures) {
  Waves drive(5);
  AttitudeFilter filter;
  for (int i = 0; i <= 3000; ++i) {
    Imu imu = drive.imu(0.01 * i);
    if (i % 2 == 0) filter.add(drive.odometry(0.01 * i));
    if (i > 1000 && i < 1010) imu.angular_rate_radps = {1e3, -1e3, 1e3};
    filter.add(imu);
  }
  const auto told = filter.at(Waves::utime(30.0));
  const Matrix3d R = drive.R(30.0);
  EXPECT_NEAR(told->roll_rad, std::atan2(R(2, 1), R(2, 2)), 4.0 * told->sd_rad);
  EXPECT_LT(told->sd_rad, 2.0 * kDegree_rad);
}

// A gap of the unit: the tilt is not known to the old precision.
TEST(AttitudeFilter, BeginsAnewAfterAGap) {
  Waves drive(3);
  AttitudeFilter filter;
  for (int i = 0; i <= 3000; ++i) {
    if (i % 2 == 0) filter.add(drive.odometry(0.01 * i));
    filter.add(drive.imu(0.01 * i));
  }
  EXPECT_LT(filter.at(Waves::utime(30.0))->sd_rad, 1.0 * kDegree_rad);
  filter.add(drive.imu(40.0));
  EXPECT_GT(filter.at(Waves::utime(40.0))->sd_rad, 5.0 * kDegree_rad);
}

}  // namespace
}  // namespace orchard::pose
