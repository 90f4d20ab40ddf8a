// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/rig_monitor.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "geometry/pose2.hpp"
#include "pose/motion.hpp"
#include "unit/pose/scan_matching/cast_world.hpp"

namespace orchard::pose {
namespace {

using geometry::compose;

constexpr double kPeriod_s = 0.2;

/// What is right: the scanners of a robot.
RigFacts right_rig() {
  RigFacts facts;
  facts.laser.mount_x_m = 0.4;
  facts.laser.mount_y_m = 0.1;
  facts.laser_rear.enabled = true;
  facts.laser_rear.mount_x_m = -0.5;
  facts.laser_rear.mount_yaw_rad = geometry::kPi;
  return facts;
}

Eigen::Vector3d mount_of(const laser::LaserConfig& laser) {
  return {laser.mount_x_m, laser.mount_y_m, laser.mount_yaw_rad};
}

struct Drive {
  std::vector<Odometry> wheels;
  std::vector<laser::Scan> front, rear;
};

/// First to and fro along a row for so many periods, then up and down the rows of a cast orchard,
/// turning to both sides, with true wheels and exact scans.
Drive driven(int num_to_and_fro) {
  const CastWorld world = orchard_world();
  const RigFacts rig = right_rig();
  Drive made;
  Eigen::Vector3d T_map_base(1.5, -4.0, 0.0);
  for (int k = 0; k < num_to_and_fro + 420; ++k) {
    const int i = k - num_to_and_fro;
    const bool is_straight = i < 0 || i % 140 < 90;
    const std::int64_t utime = static_cast<std::int64_t>(k * kPeriod_s * 1e6);
    Odometry odometry;
    odometry.utime = utime;
    odometry.speed_mps = i < 0 && k / 60 % 2 == 1 ? -0.8 : 0.8;
    odometry.yaw_rate_radps = is_straight ? 0.0 : (i / 140 % 2 == 0 ? 0.314 : -0.314);
    T_map_base = compose(T_map_base, arc_motion(odometry.speed_mps, odometry.yaw_rate_radps,
                                                k > 0 ? kPeriod_s : 0.0));
    made.wheels.push_back(odometry);
    made.front.push_back(world.scan(utime, compose(T_map_base, mount_of(rig.laser)), nullptr));
    made.rear.push_back(world.scan(utime, compose(T_map_base, mount_of(rig.laser_rear)), nullptr));
  }
  return made;
}

const Drive& true_drive() {
  static const Drive drive = driven(0);
  return drive;
}

RigMonitor checked(const RigFacts& facts, const Drive& drive, bool scans_first = false) {
  RigMonitor monitor(facts);
  const std::size_t ahead = scans_first ? 20 : 0;
  for (std::size_t i = 0; i < drive.front.size() + ahead; ++i) {
    if (i < drive.front.size()) {
      monitor.add(drive.front[i]);
      monitor.add_rear(drive.rear[i]);
    }
    if (i >= ahead) monitor.add(drive.wheels[i - ahead]);
  }
  monitor.finish();
  return monitor;
}

std::vector<std::string> names(const RigMonitor& monitor) {
  std::vector<std::string> names;
  for (const Finding& finding : monitor.findings()) names.push_back(finding.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(RigMonitor, ARightRigIsNotDoubted) {
  const RigMonitor monitor = checked(right_rig(), true_drive());
  EXPECT_EQ(names(monitor), Names{});
  ASSERT_TRUE(monitor.estimates().laser);
  EXPECT_TRUE(monitor.estimates().by_wheels);
  EXPECT_NEAR(monitor.estimates().laser->mount_x_m.value, 0.4, 0.03);
  EXPECT_NEAR(monitor.estimates().laser->mount_y_m.value, 0.1, 0.03);
  EXPECT_NEAR(monitor.estimates().laser->mount_yaw_rad.value, 0.0, 0.01);
}

TEST(RigMonitor, NamesTheKeyThatIsWrongAndTheValueThatFits) {
  RigFacts yaw = right_rig();
  yaw.laser.mount_yaw_rad = 0.09;
  const RigMonitor turned = checked(yaw, true_drive());
  ASSERT_EQ(names(turned), Names{"laser_yaw"});
  EXPECT_EQ(turned.findings()[0].key, "laser.mount_yaw_rad");
  EXPECT_NE(turned.findings()[0].text.find("0.090, but the scans move as with "), std::string::npos)
      << turned.findings()[0].text;

  RigFacts mount = right_rig();
  mount.laser_rear.mount_y_m = 0.5;
  EXPECT_EQ(names(checked(mount, true_drive())), Names{"laser_mount"});

  RigFacts exchanged = right_rig();
  std::swap(static_cast<laser::LaserConfig&>(exchanged.laser_rear), exchanged.laser);
  EXPECT_EQ(names(checked(exchanged, true_drive())), Names{"scanners_exchanged"});
}

TEST(RigMonitor, ATurnAfterLongRowsTellsTheMount) {
  RigFacts facts = right_rig();
  facts.laser.mount_x_m = 0.9;
  const RigMonitor monitor = checked(facts, driven(1200));  // 192 m
  EXPECT_EQ(names(monitor), Names{"laser_mount"});
  ASSERT_TRUE(monitor.estimates().laser);
  EXPECT_NEAR(monitor.estimates().laser->mount_x_m.value, 0.4, 0.03);
}

TEST(RigMonitor, NamesWheelsAndScansThatContradictEachOther) {
  Drive scaled = true_drive();
  for (Odometry& odometry : scaled.wheels) odometry.speed_mps *= 1.25;
  EXPECT_EQ(names(checked(right_rig(), scaled)), Names{"wheels_scale"});

  Drive late = true_drive();
  for (Odometry& odometry : late.wheels) odometry.utime += 250'000;
  EXPECT_EQ(names(checked(right_rig(), late)), Names{"wheels_delay"});

  Drive mirrored = true_drive();
  for (laser::Scan& scan : mirrored.front) {
    scan.bearing_min_rad = scan.bearing_rad(static_cast<double>(scan.ranges_m.size()) - 1.0);
    scan.bearing_step_rad = -scan.bearing_step_rad;
  }
  EXPECT_EQ(names(checked(right_rig(), mirrored)), Names{"mirrored"});
}

TEST(RigMonitor, HowTheKindsAreInterleavedDoesNotMatter) {
  RigFacts facts = right_rig();
  facts.laser.mount_yaw_rad = 0.09;
  const RigMonitor a = checked(facts, true_drive()), b = checked(facts, true_drive(), true);
  ASSERT_EQ(names(a), names(b));
  EXPECT_EQ(a.findings()[0].text, b.findings()[0].text);
}

TEST(RigMonitor, WithoutAReferenceNothingIsSaid) {
  RigMonitor monitor(right_rig());
  for (const laser::Scan& scan : true_drive().front) monitor.add(scan);
  monitor.finish();
  EXPECT_EQ(names(monitor), Names{});
  EXPECT_FALSE(monitor.estimates().laser);
}

}  // namespace
}  // namespace orchard::pose
