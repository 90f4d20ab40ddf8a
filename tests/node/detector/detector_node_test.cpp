// SPDX-License-Identifier: BSD-3-Clause
#include "detector/detector_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <random>

#include "bus/messages/codec.hpp"
#include "node/detector/detector_bench.hpp"

namespace orchard::procs {
namespace {

using detection::Detections;
using detection::Label;

std::vector<std::vector<std::uint8_t>> bytes_of(const std::vector<Detections>& sent) {
  std::vector<std::vector<std::uint8_t>> bytes;
  for (const Detections& d : sent) bytes.push_back(bus::encode(d));
  return bytes;
}

TEST(DetectorNode, AScanWaitsForItsImage) {
  Bench bench;
  bench.handle(scan(0));
  EXPECT_TRUE(bench.sent.empty());
  EXPECT_NE(bench.node.waiting_for().find("IMAGE"), std::string::npos);
  bench.handle(picture(0));
  ASSERT_EQ(bench.sent.size(), 1u);
  EXPECT_EQ(bench.node.waiting_for(), "");
  EXPECT_EQ(bench.sent[0].utime, 1'000'000);
  EXPECT_EQ(bench.sent[0].image_utime, 1'020'000);
  ASSERT_EQ(bench.sent[0].trunks.size(), 3u);
  EXPECT_EQ(bench.sent[0].trunks[0].label, Label::kTree);    // right
  EXPECT_EQ(bench.sent[0].trunks[1].label, Label::kObject);  // blue, in the middle
  EXPECT_EQ(bench.sent[0].trunks[2].label, Label::kTree);
}

TEST(DetectorNode, EveryScanIsAnsweredInOrderAlsoWithoutImages) {
  Bench bench;
  for (int i = 0; i < 10; ++i) bench.handle(scan(i));
  bench.flush();
  ASSERT_EQ(bench.sent.size(), 10u);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(bench.sent[static_cast<std::size_t>(i)].seq, i);
    EXPECT_EQ(bench.sent[static_cast<std::size_t>(i)].utime, 1'000'000 + 100'000 * i);
    EXPECT_EQ(bench.sent[static_cast<std::size_t>(i)].image_utime, 0);
    for (const auto& trunk : bench.sent[static_cast<std::size_t>(i)].trunks) {
      EXPECT_EQ(trunk.label, Label::kUnseen);
    }
  }
}

/// What a node makes of scans that travelled as bytes, each "no return" in them written as given.
std::vector<std::vector<std::uint8_t>> detections_with(float no_return) {
  Bench bench;
  for (int i = 0; i < 3; ++i) {
    laser::Scan s = scan(i);
    for (float& range_m : s.ranges_m) range_m = range_m > 0.0f ? range_m : no_return;
    const auto bytes = bus::encode(s);
    const auto decoded = bus::decode(bus::Channel::kScan, bytes.data(), bytes.size());
    if (const auto* message = std::get_if<bus::Message>(&decoded)) bench.handle(*message);
    bench.handle(picture(i));
  }
  bench.flush();
  return bytes_of(bench.sent);
}

TEST(DetectorNode, InfinitiesAndNanAreNoReturn) {
  const laser::Scan s = scan(0);
  ASSERT_GT(std::count(s.ranges_m.begin(), s.ranges_m.end(), 0.0f), 100);
  const auto with_zero = detections_with(0.0f);
  ASSERT_EQ(with_zero.size(), 3u);
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(detections_with(inf), with_zero);
  EXPECT_EQ(detections_with(-inf), with_zero);
  EXPECT_EQ(detections_with(std::numeric_limits<float>::quiet_NaN()), with_zero);
}

TEST(DetectorNode, OutputDoesNotDependOnArrivalAcrossChannels) {
  std::vector<std::vector<std::uint8_t>> reference;
  std::mt19937 random(3);
  for (int round = 0; round < 12; ++round) {
    struct Arrival {
      std::int64_t when;
      int index;
      bool is_scan;
    };
    std::vector<Arrival> arrivals;
    std::int64_t last[2] = {0, 0};
    for (int i = 0; i < 12; ++i) {
      for (const bool is_scan : {true, false}) {
        std::int64_t& previous = last[is_scan ? 0 : 1];
        previous = std::max(
            previous, 100'000 * std::int64_t{i} + static_cast<std::int64_t>(random() % 110'000));
        arrivals.push_back({previous, i, is_scan});
      }
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const Arrival& a, const Arrival& b) { return a.when < b.when; });
    Bench bench;
    for (const Arrival& a : arrivals) {
      if (a.is_scan)
        bench.handle(scan(a.index));
      else
        bench.handle(picture(a.index));
    }
    bench.flush();
    if (round == 0) reference = bytes_of(bench.sent);
    EXPECT_EQ(bytes_of(bench.sent), reference);
    EXPECT_EQ(bench.node.counts().num_late, 0);
  }
  EXPECT_EQ(reference.size(), 12u);
}

TEST(DetectorNode, CountsPicturesOfNoUse) {
  Bench bench;
  bench.handle(scan(0));
  vision::Image broken = picture(0);
  broken.data.resize(broken.data.size() / 4);
  bench.handle(broken);
  bench.handle(scan(1));
  vision::Image small = picture(1);
  small.width_px = 160;
  bench.handle(small);
  ASSERT_EQ(bench.sent.size(), 2u);
  EXPECT_EQ(bench.node.counts().num_unusable, 2);
  EXPECT_EQ(bench.sent[0].trunks[0].label, Label::kUnseen);
}

TEST(DetectorNode, CountsLatePictures) {
  Bench bench;
  for (int i = 0; i < 5; ++i) bench.handle(scan(i));
  bench.handle(picture(0, 0));
  EXPECT_EQ(bench.node.counts().num_late, 1);
}

TEST(DetectorNode, ARigWithoutACameraAnswersAtOnceAndIgnoresPictures) {
  io::Config config;
  config.camera.enabled = false;
  Bench bench(config);
  EXPECT_EQ(bench.node.inputs(), std::vector<bus::Channel>{bus::Channel::kScan});
  bench.handle(scan(0));
  ASSERT_EQ(bench.sent.size(), 1u);
  for (const auto& trunk : bench.sent[0].trunks) {
    EXPECT_EQ(trunk.roc_tree, trunk.roc_laser);
    EXPECT_NE(trunk.label, Label::kUnseen);
  }
}

TEST(DetectorNode, WaitsForOdometryWhereItIsUsed) {
  io::Config config;
  config.detector.use_odometry = true;
  Bench bench(config);
  const std::vector<bus::Channel> channels{bus::Channel::kScan, bus::Channel::kImage,
                                           bus::Channel::kOdometry};
  EXPECT_EQ(bench.node.inputs(), channels);
  bench.handle(scan(0));
  bench.handle(picture(0));
  EXPECT_TRUE(bench.sent.empty());
  EXPECT_NE(bench.node.waiting_for().find("ODOMETRY"), std::string::npos);
  pose::Odometry odometry;
  odometry.utime = 1'020'000;
  bench.handle(odometry);
  EXPECT_EQ(bench.sent.size(), 1u);
}

TEST(DetectorNode, DetectionsDoNotDependOnArrivalAcrossChannels) {
  std::vector<std::vector<std::uint8_t>> reference;
  std::mt19937 random(5);
  for (int round = 0; round < 8; ++round) {
    Bench bench;
    // Scans run ahead of the pictures by none to two, or pictures ahead of the scans.
    int next_scan = 0, next_picture = 0;
    while (next_scan < 24 || next_picture < 24) {
      const int ahead = next_scan - next_picture;
      const bool scan_next =
          next_picture >= 24 || (next_scan < 24 && ahead < 2 && (ahead < -1 || random() % 2 == 0));
      if (scan_next)
        bench.handle(scan(next_scan++));
      else
        bench.handle(picture(next_picture++));
    }
    bench.flush();
    EXPECT_EQ(bench.node.counts().num_late, 0);
    if (round == 0) reference = bench.all;
    EXPECT_EQ(bench.all, reference) << "round " << round;
  }
  EXPECT_EQ(reference.size(), 24u);
}

TEST(DetectorNode, GoesOnWithoutOdometryAndSaysSo) {
  io::Config config;
  config.detector.use_odometry = true;
  Bench bench(config);
  pose::Odometry odometry;
  odometry.utime = 1'000'000;
  bench.handle(odometry);
  bench.handle(scan(0));
  bench.handle(picture(0));
  odometry.utime = 1'040'000;
  bench.handle(odometry);
  ASSERT_EQ(bench.sent.size(), 1u);
  EXPECT_EQ(bench.node.warning(), "");
  for (int i = 1; i < 12; ++i) {  // the wheels fall silent
    bench.handle(scan(i));
    bench.handle(picture(i));
  }
  EXPECT_GE(bench.sent.size(), 9u);  // never more than image_wait_s behind
  EXPECT_NE(bench.node.warning().find("no ODOMETRY"), std::string::npos);
  odometry.utime = 2'130'000;
  bench.handle(odometry);
  bench.handle(scan(12));
  odometry.utime = 2'230'000;
  bench.handle(picture(12));
  bench.handle(odometry);
  ASSERT_EQ(bench.sent.size(), 13u);
  EXPECT_EQ(bench.node.warning(), "");  // it is back
  bench.flush();
  EXPECT_NE(bench.node.warning().find(" of 13 pictures"), std::string::npos);
}

TEST(DetectorNode, SaysThatTheCameraIsSilent) {
  Bench bench(io::Config{});
  for (int i = 0; i < 12; ++i) {
    bench.handle(scan(i));
    bench.handle(picture(i));
  }
  for (int i = 12; i < 30; ++i) bench.handle(scan(i));
  EXPECT_EQ(bench.node.warning(), "");  // not yet: pictures may be lost
  for (int i = 30; i < 60; ++i) bench.handle(scan(i));
  EXPECT_NE(bench.node.warning().find("no IMAGE"), std::string::npos);
  EXPECT_NE(bench.node.warning().find("UNSEEN"), std::string::npos);
  bench.handle(scan(60));
  bench.handle(picture(60));
  EXPECT_EQ(bench.node.warning(), "");  // it is back
  bench.flush();
  EXPECT_NE(bench.node.warning().find("48 of 61 scans"), std::string::npos);
}

TEST(DetectorNode, SaysThatNoPictureCanBeUsed) {
  Bench bench(io::Config{});
  for (int i = 0; i < 40; ++i) {
    bench.handle(scan(i));
    vision::Image image = picture(i);
    image.data.resize(image.data.size() / 2);
    for (auto& byte : image.data) byte = 7;
    bench.handle(image);
    EXPECT_TRUE(i > 10 || bench.node.warning().empty());  // not yet: a few may be damaged
  }
  EXPECT_NE(bench.node.warning().find("cannot be decoded"), std::string::npos);
  bench.handle(scan(40));
  bench.handle(picture(40));
  EXPECT_EQ(bench.node.warning(), "");
  bench.flush();
  EXPECT_NE(bench.node.warning().find("40 of 41 pictures are unusable"), std::string::npos);
}

TEST(DetectorNode, SaysThatPicturesAreOfAnotherSize) {
  io::Config config;
  config.camera.intrinsics.width_px *= 2;
  Bench bench(config);
  for (int i = 0; i < 5; ++i) {  // a recording of a few stops
    bench.handle(scan(i));
    bench.handle(picture(i));
  }
  bench.flush();
  EXPECT_NE(
      bench.node.warning().find("IMAGE is 320 x 240 px, but camera.width_px and height_px are 640"),
      std::string::npos);
}

TEST(DetectorNode, MissesNoCameraThatItHasNot) {
  io::Config config;
  config.camera.enabled = false;
  Bench bench(config);
  for (int i = 0; i < 60; ++i) bench.handle(scan(i));
  bench.flush();
  EXPECT_EQ(bench.node.warning(), "");
}

/// Half a minute of two tubes; `turned_rad`: how far the rig is wrong about where the camera looks.
std::vector<Detections> watch(io::Config config, double turned_rad, std::string& warning) {
  config.camera.extrinsics.phi_rad[2] += turned_rad;
  Bench bench(config);
  for (int i = 0; i < 300; ++i) {
    const std::vector<test::Tube> tubes{test::brown_tube(1.7 + 0.003 * (i % 50), 0.3),
                                        test::brown_tube(1.9 - 0.002 * (i % 50), -0.35)};
    laser::Scan s = test::scan_of(tubes, 1'000'000 + 100'000 * i);
    s.seq = i;
    bench.handle(s);
    vision::Image image =
        test::picture_of_tubes(tubes, test::tube_rig(), 1'000'000 + 100'000 * i + 20'000);
    image.seq = i;
    bench.handle(image);
  }
  warning = bench.node.warning();
  bench.flush();
  EXPECT_EQ(bench.node.warning().empty(), warning.empty());
  return bench.sent;
}

TEST(DetectorNode, WarnsOfACameraThatIsTurned) {
  std::string warning;
  for (const double turned_rad : {0.03, -0.03}) {  // beyond the detector's own windows
    watch({}, turned_rad, warning);
    double offset_px = 0.0;
    ASSERT_EQ(std::sscanf(warning.c_str(), "laser and image edges disagree by %lf px", &offset_px),
              1)
        << warning;
    // f tan(bearing +- 0.03) - f tan(bearing) at the tubes' bearings of some 10 degrees
    EXPECT_NEAR(offset_px, 7.7, 1.0);
    EXPECT_NE(warning.find("camera.phi_rad"), std::string::npos) << warning;
  }
  watch({}, 0.0, warning);
  EXPECT_EQ(warning, "");
}

TEST(DetectorNode, WatchingTheEdgesDoesNotTouchDetections) {
  std::string warning;
  io::Config blind;
  blind.detector.extrinsics_monitor.enabled = false;
  const auto watched = bytes_of(watch({}, 0.03, warning));
  EXPECT_FALSE(warning.empty());
  const auto unwatched = bytes_of(watch(blind, 0.03, warning));
  EXPECT_TRUE(warning.empty());
  EXPECT_EQ(watched, unwatched);
}

TEST(DetectorNode, WhatItSendsPassesTheGuard) {
  Bench bench;
  bench.handle(scan(0));
  bench.handle(picture(0));
  const auto bytes = bus::encode(bench.sent.at(0));
  const auto decoded = bus::decode(bus::Channel::kDetections, bytes.data(), bytes.size());
  ASSERT_TRUE(std::holds_alternative<bus::Message>(decoded));
  EXPECT_EQ(bus::encode(std::get<bus::Message>(decoded)), bytes);
}

}  // namespace
}  // namespace orchard::procs
