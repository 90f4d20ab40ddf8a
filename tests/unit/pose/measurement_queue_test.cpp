// SPDX-License-Identifier: BSD-3-Clause
#include "pose/measurement_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace orchard::pose {
namespace {

Odometry odometry_at(std::int64_t utime) {
  Odometry odometry;
  odometry.utime = utime;
  return odometry;
}

PoseFix fix_at(std::int64_t utime) {
  PoseFix fix;
  fix.utime = utime;
  return fix;
}

/// Waits for odometry and for fixes, as long for each.
MeasurementQueue odometry_and_fixes(double wait_s) {
  MeasurementWaits waits_s;
  waits_s[static_cast<std::size_t>(MeasurementKind::kOdometry)] = wait_s;
  waits_s[static_cast<std::size_t>(MeasurementKind::kPoseFix)] = wait_s;
  return MeasurementQueue(waits_s);
}

constexpr std::size_t kFix = static_cast<std::size_t>(MeasurementKind::kPoseFix);

std::vector<std::pair<std::int64_t, std::size_t>> drain(MeasurementQueue& queue) {
  std::vector<std::pair<std::int64_t, std::size_t>> out;
  while (const auto m = queue.pop()) {
    out.emplace_back(std::visit([](const auto& x) { return x.utime; }, *m), m->index());
  }
  return out;
}

TEST(MeasurementQueue, HoldsAMeasurementUntilTheOtherChannelReachesItsTime) {
  MeasurementQueue queue = odometry_and_fixes(0.1);
  queue.push(odometry_at(1000));
  EXPECT_FALSE(queue.pop());
  EXPECT_EQ(queue.waits_for(), MeasurementKind::kPoseFix);
  queue.push(fix_at(1000));
  EXPECT_EQ(drain(queue),
            (std::vector<std::pair<std::int64_t, std::size_t>>{{1000, 0}, {1000, kFix}}));
}

TEST(MeasurementQueue, TheWindowReleasesWhatASilentChannelHoldsBack) {
  MeasurementQueue queue = odometry_and_fixes(0.02);
  queue.push(odometry_at(0));
  queue.push(odometry_at(20000));
  EXPECT_FALSE(queue.pop());
  queue.push(odometry_at(20001));
  EXPECT_EQ(drain(queue).size(), 1u);
  queue.push(fix_at(0));  // its place in the order is gone
  EXPECT_EQ(queue.num_late(), 1);
}

TEST(MeasurementQueue, EachKindIsWaitedForAsLongAsItsOwnWindow) {
  MeasurementWaits waits_s;
  waits_s[static_cast<std::size_t>(MeasurementKind::kOdometry)] = 0.02;
  waits_s[kFix] = 0.01;
  waits_s[static_cast<std::size_t>(MeasurementKind::kDetections)] = 0.5;
  MeasurementQueue queue(waits_s);
  queue.push(odometry_at(0));
  queue.push(odometry_at(100000));
  // the fix is waited for no longer, the trunks still are
  EXPECT_EQ(queue.waits_for(), MeasurementKind::kDetections);
  queue.push(odometry_at(500001));
  EXPECT_EQ(drain(queue).size(), 1u);
  detection::Detections trunks;
  trunks.utime = 100000;
  queue.push(trunks);
  // equal times: motion first; the odometry at 500001 waits on
  EXPECT_EQ(drain(queue),
            (std::vector<std::pair<std::int64_t, std::size_t>>{
                {100000, 0}, {100000, static_cast<std::size_t>(MeasurementKind::kDetections)}}));
}

TEST(MeasurementQueue, OneChannelAloneNeverWaits) {
  MeasurementWaits waits_s;
  waits_s[kFix] = 0.02;
  MeasurementQueue queue(waits_s);
  queue.push(fix_at(5));
  EXPECT_EQ(drain(queue).size(), 1u);
}

TEST(MeasurementQueue, ArrivalOrderBetweenChannelsWithinTheWindowDoesNotMatter) {
  std::vector<std::pair<std::int64_t, std::size_t>> reference;
  std::mt19937_64 random(3);
  for (int round = 0; round < 50; ++round) {
    // odometry every 20 ms, a fix every 100 ms, each channel delayed by up to 40 ms as a whole
    std::vector<std::pair<std::int64_t, Measurement>> arrivals;
    const std::int64_t delay_us = static_cast<std::int64_t>(random() % 80001) - 40000;
    for (int i = 0; i < 50; ++i) arrivals.emplace_back(i * 20000, odometry_at(i * 20000));
    for (int i = 0; i < 10; ++i) arrivals.emplace_back(i * 100000 + delay_us, fix_at(i * 100000));
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    MeasurementQueue queue = odometry_and_fixes(0.05);
    std::vector<std::pair<std::int64_t, std::size_t>> out;
    for (const auto& arrival : arrivals) {
      queue.push(arrival.second);
      for (const auto& entry : drain(queue)) out.push_back(entry);
    }
    while (const auto m = queue.pop_flushed()) {
      out.emplace_back(std::visit([](const auto& x) { return x.utime; }, *m), m->index());
    }
    EXPECT_EQ(queue.num_late(), 0);
    EXPECT_TRUE(std::is_sorted(out.begin(), out.end()));
    if (round == 0) reference = out;
    EXPECT_EQ(out, reference) << "delay " << delay_us << " us";
  }
}

}  // namespace
}  // namespace orchard::pose
