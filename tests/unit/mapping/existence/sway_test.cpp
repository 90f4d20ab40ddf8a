// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/sway.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mapping/mapper.hpp"

namespace orchard::mapping {
namespace {

constexpr double kErrorSd_m = 0.005;  ///< of a detection, per axis, as it states
constexpr double kSway_m = 0.04;

/// A thin thing is one of the line y = -1 (a cane) or y = 1 (a stalk in the wind); trees stand at
/// y = 2. A robot passes at 1 m/s, ten scans a second, and sees what is nearer than 1.3 m to its
/// side. Its poses are off by `pose_sd_m`, which they do not state.
Mapper drive(double pose_sd_m) {
  Mapper mapper(MapperConfig{}, {0.0, 0.0});
  std::mt19937_64 random(7);
  const auto normal = [&](double sd) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random() >> 11) * 0x1p-53;
    return sd * sum;
  };
  for (int k = 0; k < 200; ++k) {
    const double time_s = 0.1 * k;
    pose::PoseEstimate pose;
    pose.utime = 1'000'000 + 100'000LL * k;
    pose.x_m = time_s;
    pose.covariance = {1e-8, 0, 0, 1e-8, 0, 1e-10};
    const double off_x_m = normal(pose_sd_m), off_y_m = normal(pose_sd_m);
    detection::Detections detections;
    detections.utime = pose.utime;
    const auto add = [&](double x_m, double y_m, bool is_tree) {
      if (std::abs(x_m - time_s) > 1.3) return;
      detection::Detection d;
      d.centre_x_m = x_m - time_s + off_x_m + normal(kErrorSd_m);
      d.centre_y_m = y_m + off_y_m + normal(kErrorSd_m);
      d.covariance = {kErrorSd_m * kErrorSd_m, 0.0, kErrorSd_m * kErrorSd_m};
      d.width_m = is_tree ? 0.12 : 0.012;
      d.width_sd_m = 0.003;
      d.num_beams = is_tree ? 20 : 2;
      d.label = is_tree ? detection::Label::kTree : detection::Label::kObject;
      detections.trunks.push_back(d);
    };
    for (int i = 1; i < 10; ++i) {
      add(2.0 * i, 2.0, true);
      add(2.0 * i + 1.0, -1.0, false);
      add(2.0 * i + 1.0 + kSway_m * std::sin(5.0 * time_s + i),
          1.0 + kSway_m * std::sin(7.0 * time_s + 2 * i), false);
    }
    mapper.update(detections, pose, nullptr);
  }
  return mapper;
}

struct Strays {
  int num_stalks = 0, num_others = 0;
};

Strays strays_of(const Mapper& mapper) {
  Strays strays;
  const std::vector<std::int32_t> ids = mapper.spurious_ids(*mapper.ground());
  for (const Landmark& l : mapper.landmarks()) {
    if (std::find(ids.begin(), ids.end(), l.id) == ids.end()) continue;
    const bool is_stalk = std::abs(l.y_m - 1.0) < 0.3;
    ++(is_stalk ? strays.num_stalks : strays.num_others);
  }
  return strays;
}

TEST(Sway, AStalkInTheWindIsStrayAndACaneIsNone) {
  const Strays strays = strays_of(drive(0.0));
  EXPECT_GE(strays.num_stalks, 9);
  EXPECT_EQ(strays.num_others, 0);
}

TEST(Sway, WhatScattersAsTreesDoIsNoStray) { EXPECT_EQ(strays_of(drive(0.04)).num_others, 0); }

}  // namespace
}  // namespace orchard::mapping
