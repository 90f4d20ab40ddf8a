// SPDX-License-Identifier: BSD-3-Clause
#include "timing/drive_time.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace orchard::timing {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr std::int64_t kHour = 3600 * kSecond;
constexpr std::int64_t kStart = 1'700'000'000 * kSecond;

struct Sent {
  std::int64_t true_us;  ///< since the start of the drive
  std::size_t kind;
  std::int64_t utime;
};

/// Kinds of 50, 10 and 1 Hz for a minute, whose clocks are all set by a step at half of it.
std::vector<Sent> drive(std::int64_t step_us) {
  std::vector<Sent> all;
  const std::int64_t periods_us[] = {kSecond / 50, kSecond / 10, kSecond};
  for (std::size_t kind = 0; kind < 3; ++kind) {
    for (std::int64_t t = 3000 * static_cast<std::int64_t>(kind); t < 60 * kSecond;
         t += periods_us[kind]) {
      all.push_back({t, kind, kStart + t + (t < 30 * kSecond ? 0 : step_us)});
    }
  }
  return all;
}

/// The order of arrival when each kind has a delay of its own, up to half a second and changing.
std::vector<Sent> arrived(const std::vector<Sent>& sent, std::mt19937_64& random) {
  std::array<std::int64_t, 3> delays_us{}, last{};
  for (std::int64_t& delay : delays_us) delay = static_cast<std::int64_t>(random() % 400'000);
  std::vector<std::pair<std::int64_t, Sent>> arrivals;
  for (const Sent& s : sent) {
    const std::int64_t jitter_us = static_cast<std::int64_t>(random() % 100'000);
    last[s.kind] = std::max(last[s.kind], s.true_us + delays_us[s.kind] + jitter_us);
    arrivals.emplace_back(last[s.kind], s);
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Sent> order;
  for (const auto& arrival : arrivals) order.push_back(arrival.second);
  return order;
}

TEST(DriveClock, SetClocksKeepTheOrderOfTheDriveInWhateverOrderTheKindsArrive) {
  std::mt19937_64 random(11);
  for (const std::int64_t step_us : {-24 * kHour, -kHour, -60 * kSecond, -20 * kSecond,
                                     -4 * kSecond, 0L, 3 * kSecond, kHour, 24 * kHour}) {
    const std::vector<Sent> sent = drive(step_us);
    for (int round = 0; round < 100; ++round) {
      DriveClock clock(3);
      std::map<std::int64_t, std::int64_t> drive_time_of_true;
      for (const Sent& s : arrived(sent, random)) {
        const auto drive_time = clock.next(s.kind, s.utime);
        ASSERT_TRUE(drive_time) << "none is late";
        ASSERT_EQ(utime_of(*drive_time), s.utime);
        ASSERT_EQ(epoch_of(*drive_time), step_us < 0 && s.true_us >= 30 * kSecond ? 1 : 0)
            << step_us << " kind " << s.kind << " at " << s.true_us;
      }
    }
  }
}

TEST(DriveClock, ASmallFallIsLateUntilItsTimeHasCome) {
  DriveClock clock(1);
  EXPECT_EQ(clock.next(0, kStart), kStart);
  EXPECT_EQ(clock.next(0, kStart - kSecond), std::nullopt);
  EXPECT_EQ(clock.next(0, kStart), kStart);
}

TEST(DriveClock, AKindThatWasSilentMeanwhileFollowsTheOthers) {
  DriveClock clock(2);
  clock.next(0, kStart);
  clock.next(1, kStart);
  for (int i = 0; i < 600; ++i) clock.next(0, kStart + i * kSecond);
  for (int i = 0; i < 60; ++i) clock.next(0, kStart + (540 + i) * kSecond);
  EXPECT_EQ(epoch_of(*clock.next(1, kStart + 599 * kSecond)), 1);
  EXPECT_EQ(epoch_of(*clock.next(0, kStart + 600 * kSecond)), 1);
}

TEST(DriveClock, ASenderOfAnotherClockJoinsWhenThatIsSet) {
  DriveClock clock(2);  // kind 1 is an hour ahead, until its clock is set to that of the other
  for (int i = 0; i < 60; ++i) {
    clock.next(0, kStart + i * kSecond);
    clock.next(1, kStart + i * kSecond + (i < 30 ? kHour : 0));
  }
  EXPECT_EQ(*clock.next(1, kStart + 60 * kSecond) - *clock.next(0, kStart + 60 * kSecond), 0);
}

TEST(DriveClock, GoesOnInAnotherProcess) {
  DriveClock clock(2);
  clock.resume(0, 3 * kEpoch_us + kStart);
  clock.resume(1, 3 * kEpoch_us + kStart + kSecond);
  EXPECT_EQ(clock.next(0, kStart - kHour), 4 * kEpoch_us + kStart - kHour) << "set back meanwhile";
  EXPECT_EQ(clock.next(1, kStart + 2 * kSecond), 3 * kEpoch_us + kStart + 2 * kSecond);
}

TEST(DriveClock, SetBackForEverItStaysWithinItsBits) {
  DriveClock clock(1);
  std::int64_t last = 0;
  for (int i = 0; i < 3000; ++i) {
    clock.next(0, kEpoch_us - 1);
    last = std::max(last, clock.next(0, 1).value_or(0));
  }
  EXPECT_EQ(epoch_of(last), kEpochsMax - 1);
}

TEST(SteadyTime, PassesAsBeforeWhereAClockIsSetBack) {
  SteadyTime<2> steady;
  std::int64_t last = 0;
  for (std::int64_t i = 0; i < 100; ++i) {
    const std::int64_t drive_time = i < 50 ? i * 20'000 + kHour : kEpoch_us + i * 20'000;
    if (i % 5 == 0) {
      EXPECT_EQ(steady.next(1, drive_time), kHour + i * 20'000);
    }
    last = steady.next(0, drive_time);
    EXPECT_EQ(last, kHour + i * 20'000);
    EXPECT_EQ(steady.drive_time(last), drive_time);
  }
  EXPECT_EQ(steady.drive_time(kHour + 49 * 20'000), kHour + 49 * 20'000) << "of the past, too";
}

}  // namespace
}  // namespace orchard::timing
