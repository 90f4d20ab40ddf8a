// SPDX-License-Identifier: BSD-3-Clause
#include "detection/rear_joiner.hpp"

#include "geometry/angles.hpp"

namespace orchard::detection {
namespace {

constexpr std::int64_t kTurn_us = 100'000;

Detection trunk(std::int64_t utime, double x_m, double y_m, Label label = Label::kTree) {
  Detection d;
  d.utime = utime;
  d.centre_x_m = x_m;
  d.centre_y_m = y_m;
  d.surface_x_m = 0.99 * x_m;
  d.surface_y_m = 0.99 * y_m;
  d.width_m = 0.1;
  d.covariance = {1e-4, 0.0, 1e-4};
  d.label = label;
  d.bearing_rad = std::atan2(y_m, x_m);
  return d;
}

Detections view(std::int64_t utime, std::vector<Detection> trunks) {
  Detections detections;
  detections.utime = utime;
  detections.trunks = std::move(trunks);
  return detections;
}

TEST(RearJoiner, OneViewHoldsWhatBothSaw) {
  RearJoiner joiner({}, 0.5);
  EXPECT_TRUE(joiner.add_front(view(0, {trunk(10, 2.0, 1.0)}), kTurn_us).empty());
  EXPECT_EQ(joiner.waiting_utime(), 0);
  const auto views = joiner.add_rear(view(40'000, {trunk(45'000, -2.0, 1.0)}));
  ASSERT_EQ(views.size(), 1u);
  EXPECT_EQ(views[0].utime, 0);
  ASSERT_EQ(views[0].trunks.size(), 2u);
  EXPECT_EQ(views[0].trunks[1].centre_x_m, -2.0);
  EXPECT_EQ(views[0].trunks[1].utime, 45'000);
}

TEST(RearJoiner, RangeAndBearingAreThoseOfTheFirstScanner) {
  laser::LaserConfig mount;
  mount.mount_x_m = 0.5;
  mount.mount_yaw_rad = 0.3;
  RearJoiner joiner(mount, 0.5);
  joiner.add_front(view(0, {}), kTurn_us);
  Detection seen = trunk(0, -1.5, 0.0);
  seen.surface_x_m = -1.5;
  const auto views = joiner.add_rear(view(0, {seen}));
  EXPECT_NEAR(views.at(0).trunks.at(0).range_m, 2.0, 1e-12);
  EXPECT_NEAR(views.at(0).trunks.at(0).bearing_rad, geometry::kPi - 0.3, 1e-12);
}

TEST(RearJoiner, WhatBothSeeCountsOnceAndTheCamerasWordStays) {
  RearJoiner joiner({}, 0.5);
  joiner.add_front(view(0, {trunk(0, 0.0, 2.0), trunk(0, 0.0, -2.0, Label::kUnseen)}), kTurn_us);
  // Half a second at 0.6 m/s later by their own times: 30 ms, 18 mm.
  const auto views = joiner.add_rear(view(30'000, {trunk(30'000, -0.018, 2.0, Label::kUnseen),
                                                   trunk(30'000, -0.018, -2.0, Label::kTree)}));
  ASSERT_EQ(views.at(0).trunks.size(), 2u);
  for (const Detection& d : views[0].trunks) EXPECT_EQ(d.label, Label::kTree);
  EXPECT_EQ(views[0].trunks[0].utime, 30'000);  // bearing -90 degrees: the second scanner's
  EXPECT_EQ(views[0].trunks[1].utime, 0);
}

TEST(RearJoiner, TheWheelsTellWhetherItIsTheSameTrunk) {
  // At 1.5 m/s and 0.4 rad/s; seen by the one at 0, by the other 80 ms later, 0.12 m farther on.
  constexpr double kSpeed_mps = 1.5, kRate_radps = 0.4;
  const double since_s = 0.08, turn_rad = kRate_radps * since_s,
               radius_m = kSpeed_mps / kRate_radps;
  const double way_x_m = radius_m * std::sin(turn_rad);
  const double way_y_m = radius_m * (1.0 - std::cos(turn_rad));
  const auto later = [&](double x_m, double y_m) {
    const double dx_m = x_m - way_x_m, dy_m = y_m - way_y_m;
    return trunk(80'000, std::cos(turn_rad) * dx_m + std::sin(turn_rad) * dy_m,
                 -std::sin(turn_rad) * dx_m + std::cos(turn_rad) * dy_m);
  };
  RearJoiner joiner({}, 0.5, true);
  joiner.add_front(view(0, {trunk(0, 0.0, 2.0), trunk(0, 0.3, -2.0)}), kTurn_us);
  EXPECT_TRUE(joiner.add_rear(view(80'000, {later(0.0, 2.0), later(0.15, -2.0)})).empty())
      << "the wheels have not been heard";
  joiner.add({-20'000, kSpeed_mps, kRate_radps});
  const auto views = joiner.add({30'000, 0.0, 0.0});
  // Trunks of 0.1 m that stand 0.15 m apart are two, and so they are 0.12 m on.
  EXPECT_EQ(views.at(0).trunks.size(), 3u);
}

TEST(RearJoiner, NeighboursStayTwo) {
  RearJoiner joiner({}, 0.5);
  joiner.add_front(view(0, {trunk(0, 0.0, 2.0)}), kTurn_us);
  EXPECT_EQ(joiner.add_rear(view(0, {trunk(0, 0.25, 2.0)})).at(0).trunks.size(), 2u);
}

TEST(RearJoiner, TheOrderOfTheChannelsDoesNotMatter) {
  struct Event {
    bool rear;
    std::int64_t utime;
  };
  std::vector<Event> events;
  for (int i = 0; i < 20; ++i) {
    events.push_back({false, i * 100'000});
    events.push_back({true, i * 93'000 + 20'000});  // a scanner of another rate
  }
  const auto run = [](const std::vector<Event>& order) {
    RearJoiner joiner({}, 5.0);
    std::vector<Detections> all;
    for (const Event& e : order) {
      auto out = e.rear ? joiner.add_rear(view(e.utime, {trunk(e.utime, -1.0, 0.5)}))
                        : joiner.add_front(view(e.utime, {trunk(e.utime, 1.0, 0.5)}), kTurn_us);
      for (auto& v : out) all.push_back(std::move(v));
    }
    for (auto& v : joiner.flush()) all.push_back(std::move(v));
    std::vector<std::vector<std::int64_t>> times;
    for (const auto& v : all) {
      times.push_back({v.utime});
      for (const auto& d : v.trunks) times.back().push_back(d.utime);
    }
    return times;
  };
  std::vector<Event> by_time = events;
  std::sort(by_time.begin(), by_time.end(),
            [](const Event& a, const Event& b) { return a.utime < b.utime; });
  std::vector<Event> rear_first = events;
  std::stable_sort(rear_first.begin(), rear_first.end(),
                   [](const Event& a, const Event& b) { return a.rear > b.rear; });
  EXPECT_EQ(run(by_time), run(rear_first));
  EXPECT_EQ(run(by_time).size(), 20u);
}

TEST(RearJoiner, ASilentSecondScannerHoldsNothingUpForLong) {
  RearJoiner joiner({}, 0.25);
  std::size_t num_views = 0;
  for (int i = 0; i < 10; ++i) {
    num_views += joiner.add_front(view(i * 100'000, {trunk(0, 1.0, 0.0)}), kTurn_us).size();
  }
  EXPECT_EQ(num_views, 7u);  // those more than 0.25 s behind the newest
}

TEST(RearJoiner, AnEarlierOrMuchLaterSweepIsOfAnotherView) {
  RearJoiner joiner({}, 5.0);
  joiner.add_rear(view(50'000, {trunk(50'000, -1.0, 0.0)}));
  joiner.add_front(view(100'000, {trunk(100'000, 1.0, 0.0)}), kTurn_us);
  const auto views = joiner.add_rear(view(250'000, {trunk(250'000, -1.0, 0.0)}));
  EXPECT_EQ(views.at(0).trunks.size(), 1u);
}

TEST(TurnTime, FollowsFromTheBeams) {
  laser::Scan scan;
  scan.bearing_step_rad = -2.0 * geometry::kPi / 1440.0;
  scan.beam_period_us = 25'000.0 / 1440.0;
  EXPECT_EQ(turn_us(scan), 25'000);
  scan.beam_period_us = 0.0;
  EXPECT_EQ(turn_us(scan), 100'000);
}

}  // namespace
}  // namespace orchard::detection
