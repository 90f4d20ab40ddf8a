// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <random>

#include "detection/detect.hpp"
#include "detection/motion.hpp"
#include "detection/scan_image_pairer.hpp"
#include "detection/trunk_view.hpp"
#include "timing/drive_time.hpp"
#include "unit/detection/tube_rig.hpp"

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

TEST(ScanImagePairer, AClockThatIsSetBackSeparatesNoPairWhicheverChannelItReachesFirst) {
  for (const std::int64_t set_us :
       {timing::kEpoch_us - 3'600'000'000, timing::kEpoch_us - 60'000'000}) {
    for (const int lead : {-2, 0, 2}) {  // messages by which the images are ahead of the scans
      ScanImagePairer pairer(0.06, 0.25);
      const auto utime = [&](int i) { return 7'200'000'000 + i * 100'000 + (i < 50 ? 0 : set_us); };
      Pairs pairs;
      const auto take = [&pairs](Pairs more) {
        std::move(more.begin(), more.end(), std::back_inserter(pairs));
      };
      for (int i = -2; i < 102; ++i) {
        if (i + lead >= 0 && i + lead < 100) take(pairer.add(image_at(utime(i + lead) + 10'000)));
        if (i >= 0 && i < 100) take(pairer.add(scan_at(utime(i))));
      }
      take(pairer.flush());
      ASSERT_EQ(pairs.size(), 100u);
      for (int i = 0; i < 100; ++i) {
        const ScanImagePair& pair = pairs[static_cast<std::size_t>(i)];
        EXPECT_EQ(pair.scan.utime, utime(i));
        ASSERT_TRUE(pair.image) << i << ", lead " << lead;
        EXPECT_EQ(pair.image->utime, utime(i) + 10'000);
      }
    }
  }
}

TEST(ScanImagePairer, WhatWaitsIsBounded) {
  // pictures of another clock: a scan waits for one of its time that never comes
  ScanImagePairer pairer(0.06, 3600.0);
  std::size_t num_pairs = 0;
  for (int i = 0; i < 1000; ++i) num_pairs += pairer.add(scan_at(1'000'000 + i * 100'000)).size();
  EXPECT_EQ(num_pairs, 1000u - 256u);
}

TEST(Motion, StraightAheadBringsThingsNearer) {
  const PlanePoint p = after_motion({2.0, 0.5}, {0, 1.5, 0.0}, 0.1);
  EXPECT_NEAR(p.x_m, 1.85, 1e-12);
  EXPECT_NEAR(p.y_m, 0.5, 1e-12);
}

TEST(Motion, TurningLeftMovesThingsRight) {
  const PlanePoint p = after_motion({2.0, 0.0}, {0, 0.0, 0.5}, 0.2);
  EXPECT_NEAR(p.x_m, 2.0 * std::cos(0.1), 1e-12);
  EXPECT_NEAR(p.y_m, -2.0 * std::sin(0.1), 1e-12);
}

TEST(Motion, ManySmallStepsMakeTheSameArc) {
  const Motion motion{0, 1.2, 0.8};
  PlanePoint p{1.5, -0.4};
  for (int i = 0; i < 1000; ++i) p = after_motion(p, motion, 0.001);
  const PlanePoint once = after_motion({1.5, -0.4}, motion, 1.0);
  EXPECT_NEAR(p.x_m, once.x_m, 1e-9);
  EXPECT_NEAR(p.y_m, once.y_m, 1e-9);
  const PlanePoint back = after_motion(once, motion, -1.0);
  EXPECT_NEAR(back.x_m, 1.5, 1e-12);
  EXPECT_NEAR(back.y_m, -0.4, 1e-12);
}

TEST(Motion, DetectionsFollowTheRobotFromTheBeamToThePicture) {
  laser::LaserConfig mount;
  mount.mount_x_m = 0.3;
  const Rig rig = test::tube_rig({}, true, mount);
  const auto scan = test::scan_of({test::brown_tube(1.6, 0.3)});
  const Motion motion{0, 1.5, 1.0};
  for (const double dt_s : {0.05, 0.1, -0.1}) {
    // Where the laser would see the tube that long after the beam that saw it.
    PlanePoint later = after_motion({1.9, 0.3}, motion, dt_s);
    const auto beam_utime = detect(scan, nullptr, rig).detections.trunks.at(0).utime;
    const auto image = test::picture_of_tubes({test::brown_tube(later.x_m - 0.3, later.y_m)}, rig,
                                              beam_utime + static_cast<std::int64_t>(1e6 * dt_s));
    const Detection without = detect(scan, &image, rig).detections.trunks.at(0);
    const Detection with = detect(scan, &image, rig, motion).detections.trunks.at(0);
    EXPECT_GT(with.roc_colour, 0.95f);
    EXPECT_GT(with.roc_edges, 0.8f);
    EXPECT_LT(without.roc_colour, with.roc_colour - 0.1f);
  }
}

TEST(Motion, EachSideOfAnObjectMovesFromItsOwnBeam) {
  // A slow scanner, so that the robot turns while it passes one trunk.
  const Rig rig = test::tube_rig();
  auto scan = test::scan_of({test::brown_tube(1.5, 0.0)});
  scan.beam_period_us = 2000.0;
  const auto segment = laser::segment(scan, rig.detector.segmentation, rig.detector.width).at(0);
  const double yaw_rate_radps = 0.5;
  const double first_dt_s = 0.75;
  const ScanToPicture motion{Motion{0, 0.0, yaw_rate_radps}, first_dt_s, 2e-3};
  const auto moved = view_of(segment, rig, motion);
  ASSERT_TRUE(moved.has_value());
  const auto column = [&](double bearing_rad, double beam) {
    const double turned_rad = yaw_rate_radps * (first_dt_s - 2e-3 * beam);
    const auto& camera = rig.camera.intrinsics();
    return camera.cc_px[0] - camera.fc_px[0] * std::tan(bearing_rad - turned_rad);
  };
  EXPECT_NEAR(moved->right_x_px,
              column(segment.start_bearing_rad, static_cast<double>(segment.first_beam)), 1e-6);
  EXPECT_NEAR(moved->left_x_px,
              column(segment.end_bearing_rad, static_cast<double>(segment.last_beam)), 1e-6);
}

TEST(Motion, ThePictureCountsAtItsExposure) {
  geometry::CameraConfig camera;
  camera.delay_s = 0.05;
  const Rig rig({}, camera, {});
  LaserFindings findings;
  findings.detections.utime = 1'000'000;
  findings.beam_period_s = 1e-4;
  vision::Image image;
  image.utime = 1'080'000;
  EXPECT_FALSE(to_picture(findings, image, rig, std::nullopt).motion.has_value());
  const auto motion = to_picture(findings, image, rig, Motion{0, 1.0, 0.0});
  ASSERT_TRUE(motion.motion.has_value());
  EXPECT_NEAR(motion.dt_s(0.0), 0.03, 1e-12);
  EXPECT_NEAR(motion.dt_s(500.0), -0.02, 1e-12);
}

}  // namespace
}  // namespace orchard::detection
