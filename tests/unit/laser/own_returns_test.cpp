// SPDX-License-Identifier: BSD-3-Clause
#include "laser/own_returns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/angles.hpp"

namespace orchard::laser {
namespace {

using geometry::kPi;

OwnReturnsConfig config_of() {
  OwnReturnsConfig config;
  config.range_max_m = 10.0;
  config.min_beams = 2;
  config.range_sd_m = 0.01;
  return config;
}

Scan full_turn() {
  Scan scan;
  scan.bearing_min_rad = -kPi;
  scan.bearing_step_rad = kPi / 360.0;
  scan.range_min_m = 0.05;
  scan.range_max_m = 12.0;
  scan.ranges_m.assign(720, 0.0f);
  return scan;
}

std::size_t beam_at(const Scan& scan, double bearing_rad) {
  return static_cast<std::size_t>(
      std::lround((bearing_rad - scan.bearing_min_rad) / scan.bearing_step_rad));
}

/// Trunks that come from anywhere beyond 1.5 m, each beam for itself.
void show_world(Scan& scan, std::mt19937& random) {
  std::uniform_real_distribution<float> range_m(1.5f, 9.0f);
  for (float& r : scan.ranges_m) r = random() % 3 == 0 ? 0.0f : range_m(random);
}

/// Something from bearing to bearing that `share` of the scans show.
void show_own(Scan& scan, double from_rad, double to_rad, float range_m, double fraction,
              std::mt19937& random) {
  if (std::uniform_real_distribution<>(0.0, 1.0)(random) > fraction) return;
  std::normal_distribution<float> noise_m(0.0f, 0.01f);
  for (std::size_t i = beam_at(scan, from_rad); i <= beam_at(scan, to_rad); ++i) {
    scan.ranges_m[i] = range_m + noise_m(random);
  }
}

TEST(OwnReturns, ABodyIsFoundAndHiddenWhole) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    OwnReturns own(config_of());
    for (int i = 0; i < 100; ++i) {
      Scan scan = full_turn();
      show_world(scan, random);
      show_own(scan, 2.0, 2.2, 0.6f, 0.8, random);
      own.add(scan);
      EXPECT_FALSE(i < 40 && own.found()) << "said after " << i << " scans";
    }
    const auto found = own.found();
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_GT(found->reach_m, 0.6);
    EXPECT_LE(found->reach_m, 2.1);
    EXPECT_TRUE(found->sector.contains(2.0));
    EXPECT_TRUE(found->sector.contains(2.2));
    EXPECT_LT(found->sector.half_width_rad, 0.12);
  }
}

TEST(OwnReturns, OneSectorHoldsTwoMastsAcrossTheTurnsEnd) {
  std::mt19937 random(1);
  OwnReturns own(config_of());
  for (int i = 0; i < 100; ++i) {
    Scan scan = full_turn();
    show_world(scan, random);
    show_own(scan, -3.1, -3.0, 0.5f, 1.0, random);
    show_own(scan, 2.8, 2.9, 0.5f, 1.0, random);
    own.add(scan);
  }
  ASSERT_TRUE(own.found());
  const BlindSector sector = own.found()->sector;
  for (const double bearing_rad : {-3.1, -3.0, 3.1, 2.8, 2.9}) {
    EXPECT_TRUE(sector.contains(bearing_rad)) << bearing_rad;
  }
  EXPECT_LT(sector.half_width_rad, 0.3);
}

TEST(OwnReturns, WhatIsHiddenAlreadyIsNotSaid) {
  std::mt19937 random(1);
  OwnReturnsConfig config = config_of();
  config.blind = {2.1, 0.2};
  OwnReturns own(config);
  for (int i = 0; i < 100; ++i) {
    Scan scan = full_turn();
    show_world(scan, random);
    show_own(scan, 2.0, 2.2, 0.6f, 1.0, random);
    own.add(scan);
  }
  EXPECT_FALSE(own.found());
}

/// A wall beside a robot that wanders by decimetres is the world: it is where nothing else is, too.
TEST(OwnReturns, AWallBesideTheWayIsTheWorld) {
  for (const bool both_sides : {false, true}) {
    std::mt19937 random(1);
    std::normal_distribution<> wander_m(0.0, 0.2), heading_rad(0.0, 0.05);
    OwnReturns own(config_of());
    for (int i = 0; i < 300; ++i) {
      Scan scan = full_turn();
      show_world(scan, random);
      const double off_m = wander_m(random), turned_rad = heading_rad(random);
      for (std::size_t k = 0; k < scan.ranges_m.size(); ++k) {
        const double side = std::sin(scan.bearing_rad(static_cast<double>(k)) + turned_rad);
        const double wall_m = side > 0.0 ? 2.0 - off_m : 2.0 + off_m;
        if ((side > 0.25 || (both_sides && side < -0.25))) {
          scan.ranges_m[k] = static_cast<float>(wall_m / std::abs(side));
        }
      }
      own.add(scan);
    }
    EXPECT_FALSE(own.found()) << both_sides;
  }
}

TEST(OwnReturns, ARobotThatStandsSaysNothing) {
  std::mt19937 random(1);
  Scan scan = full_turn();
  show_world(scan, random);
  OwnReturns own(config_of());
  for (int i = 0; i < 300; ++i) own.add(scan);
  EXPECT_FALSE(own.found());
}

}  // namespace
}  // namespace orchard::laser
