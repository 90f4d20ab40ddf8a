// SPDX-License-Identifier: BSD-3-Clause
#include "detection/scan_image_pairer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace orchard::detection {
namespace {

laser::Scan scan_at(std::int64_t utime) {
  laser::Scan scan;
  scan.utime = utime;
  return scan;
}

vision::Image image_at(std::int64_t utime) {
  vision::Image image;
  image.utime = utime;
  return image;
}

using Pairs = std::vector<ScanImagePair>;

TEST(ScanImagePairer, WaitsForAnImageAtOrAfterTheScan) {
  ScanImagePairer pairer(0.06, 0.25);
  EXPECT_TRUE(pairer.add(image_at(990'000)).empty());
  EXPECT_TRUE(pairer.add(scan_at(1'000'000)).empty());
  EXPECT_EQ(pairer.waiting_scan_utime(), 1'000'000);
  const Pairs pairs = pairer.add(image_at(1'023'000));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].image->utime, 990'000);  // nearer than 23 ms
  EXPECT_EQ(pairer.waiting_scan_utime(), std::nullopt);
}

TEST(ScanImagePairer, AnImageAtTheScansTimeDecidesAtOnce) {
  ScanImagePairer pairer(0.06, 0.25);
  pairer.add(image_at(1'000'000));
  const Pairs pairs = pairer.add(scan_at(1'000'000));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].image->utime, 1'000'000);
}

TEST(ScanImagePairer, ImagesBeyondTheToleranceAreNoPair) {
  ScanImagePairer pairer(0.06, 0.25);
  pairer.add(scan_at(1'000'000));
  const Pairs pairs = pairer.add(image_at(1'060'001));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].image, nullptr);
  pairer.add(scan_at(2'000'000));
  EXPECT_NE(pairer.add(image_at(2'060'000))[0].image, nullptr);
}

TEST(ScanImagePairer, GivesUpWhenMessageTimeHasPassed) {
  ScanImagePairer pairer(0.06, 0.25);
  pairer.add(scan_at(1'000'000));
  EXPECT_TRUE(pairer.add(scan_at(1'250'000)).empty());
  const Pairs pairs = pairer.add(scan_at(1'250'001));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].scan.utime, 1'000'000);
  EXPECT_EQ(pairs[0].image, nullptr);
  EXPECT_EQ(pairer.num_late(), 0);
  pairer.add(image_at(1'010'000));
  EXPECT_EQ(pairer.num_late(), 1);
}

TEST(ScanImagePairer, FlushDecidesAllInOrder) {
  ScanImagePairer pairer(0.06, 0.25);
  pairer.add(image_at(1'090'000));
  pairer.add(scan_at(1'100'000));
  pairer.add(scan_at(1'200'000));
  const Pairs pairs = pairer.flush();
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].image->utime, 1'090'000);
  EXPECT_EQ(pairs[1].image, nullptr);
  EXPECT_TRUE(pairer.flush().empty());
}

TEST(ScanImagePairer, PairsDoNotDependOnArrivalAcrossChannels) {
  std::mt19937 random(5);
  struct Arrival {
    std::int64_t utime, arrives;
    bool is_scan;
  };
  std::vector<Arrival> messages;
  for (int i = 0; i < 200; ++i) {
    messages.push_back({i * 100'000 + static_cast<int>(random() % 9000), 0, true});
    if (random() % 10 != 0) {
      messages.push_back({i * 66'000 + static_cast<int>(random() % 9000), 0, false});
    }
  }
  std::map<std::int64_t, std::int64_t> reference;
  for (int round = 0; round < 30; ++round) {
    // Each channel as a whole lags by up to 120 ms, differently from message to message, but
    // never overtakes itself.
    std::int64_t last[2] = {0, 0};
    for (Arrival& m : messages) {
      std::int64_t& previous = last[m.is_scan ? 0 : 1];
      m.arrives = std::max(previous, m.utime + static_cast<int>(random() % 120'000));
      previous = m.arrives;
    }
    auto order = messages;
    std::stable_sort(order.begin(), order.end(),
                     [](const Arrival& a, const Arrival& b) { return a.arrives < b.arrives; });
    ScanImagePairer pairer(0.04, 0.25);
    std::map<std::int64_t, std::int64_t> found;
    const auto note = [&found](const Pairs& pairs) {
      for (const auto& pair : pairs) {
        found[pair.scan.utime] = pair.image ? pair.image->utime : 0;
      }
    };
    for (const Arrival& m : order) {
      note(m.is_scan ? pairer.add(scan_at(m.utime)) : pairer.add(image_at(m.utime)));
    }
    note(pairer.flush());
    if (round == 0) reference = found;
    EXPECT_EQ(found, reference);
    EXPECT_EQ(found.size(), 200u);
  }
}

TEST(ScanImagePairer, PicturesCountAtTheirExposure) {
  ScanImagePairer pairer(0.06, 0.25, false, 0.08);
  pairer.add(image_at(1'000'000));  // exposed 80 ms before: too early
  EXPECT_TRUE(pairer.add(scan_at(1'000'000)).empty());
  const Pairs pairs = pairer.add(image_at(1'100'000));
  ASSERT_EQ(pairs.size(), 1u);
  ASSERT_NE(pairs[0].image, nullptr);
  EXPECT_EQ(pairs[0].image->utime, 1'100'000);  // its own utime stays
}

// A motion is the mean since the one before: a picture belongs to the one that ends behind it.
TEST(ScanImagePairer, APictureHasTheMotionThatItLiesIn) {
  ScanImagePairer pairer(0.06, 0.25, true);
  for (int i = 0; i <= 10; ++i) pairer.add(Motion{1'000'000 + 40'000 * i, 0.1 * i, 0.0});
  pairer.add(scan_at(1'200'000));
  const Pairs pairs = pairer.add(image_at(1'205'000));  // nearer to the motion of 1.20 s
  ASSERT_EQ(pairs.size(), 1u);
  ASSERT_TRUE(pairs[0].motion);
  EXPECT_EQ(pairs[0].motion->utime, 1'240'000);
}

TEST(ScanImagePairer, CountsPicturesThatFoundNoMotion) {
  ScanImagePairer pairer(0.06, 0.25, true);
  pairer.add(Motion{1'000'000, 1.0, 0.0});
  for (int i = 0; i < 20; ++i) {
    pairer.add(scan_at(1'000'000 + 100'000 * i));
    pairer.add(image_at(1'010'000 + 100'000 * i));
  }
  EXPECT_GT(pairer.num_without_motion(), 10);  // decided although none came for two seconds
  pairer.flush();
  EXPECT_EQ(pairer.num_without_motion(), 18);  // the first two are within 200 ms of the motion
}

TEST(ScanImagePairer, ImagesWithoutScansDoNotFillTheMemory) {
  ScanImagePairer pairer(0.06, 0.25);
  std::weak_ptr<const vision::Image> first;
  pairer.add(image_at(1'000'000));
  for (int i = 1; i < 100'000; ++i) pairer.add(image_at(1'000'000 + i));
  const Pairs pairs = pairer.add(scan_at(1'000'000));
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].image, nullptr);  // those near it are long forgotten
}

TEST(ScanImagePairer, AScanOfTomorrowHoldsUpNothingOnceTheClockIsSetBack) {
  constexpr std::int64_t kDay = 86'400'000'000;
  ScanImagePairer pairer(0.06, 0.25);
  pairer.add(scan_at(kDay));
  std::size_t num_pairs = 0;
  for (int i = 0; i < 100; ++i) {
    num_pairs += pairer.add(scan_at(1'000'000 + i * 100'000)).size();
    num_pairs += pairer.add(image_at(1'010'000 + i * 100'000)).size();
  }
  EXPECT_EQ(num_pairs, 101u);
}

TEST(ScanImagePairer, WhatWaitsIsBounded) {
  // pictures of another clock: a scan waits for one of its time that never comes
  ScanImagePairer pairer(0.06, 3600.0);
  std::size_t num_pairs = 0;
  for (int i = 0; i < 1000; ++i) num_pairs += pairer.add(scan_at(1'000'000 + i * 100'000)).size();
  EXPECT_EQ(num_pairs, 1000u - 256u);
}

}  // namespace
}  // namespace orchard::detection
