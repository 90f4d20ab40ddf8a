// SPDX-License-Identifier: BSD-3-Clause
#include "detector/detector_node.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <limits>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <utility>
#include <vector>

#include "bus/messages/codec.hpp"
#include "geometry/angles.hpp"
#include "unit/detection/tube_rig.hpp"

namespace orchard::procs {
namespace {

std::vector<test::Tube> scene(int i) {
  return {test::brown_tube(2.0 - 0.02 * i, 0.4), test::brown_tube(1.6 - 0.02 * i, -0.4),
          test::blue_tube(2.2 - 0.02 * i, 0.0)};
}

laser::Scan scan(int i) {
  laser::Scan s = test::scan_of(scene(i), 1'000'000 + 100'000 * i);
  s.seq = i;
  return s;
}

vision::Image picture(int i, std::int64_t offset_us = 20'000) {
  const auto rig = test::tube_rig();
  vision::Image image = test::picture_of_tubes(scene(i), rig, 1'000'000 + 100'000 * i + offset_us);
  const cv::Mat raw(image.height_px, image.width_px, CV_8UC3, image.data.data());
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", raw, jpeg, {cv::IMWRITE_JPEG_QUALITY, 88});
  image.encoding = vision::Encoding::kJpeg;
  image.data = jpeg;
  image.seq = i;
  return image;
}

/// A node and what it sent.
struct Bench {
  explicit Bench(const io::Config& config = {}) : node(config) {}
  void handle(bus::Message message) { node.handle(message, outbox()); }
  void flush() { node.flush(outbox()); }
  bus::Outbox outbox() {
    return [this](bus::Message m) {
      all.push_back(bus::encode(m));
      if (const auto* detections = std::get_if<detection::Detections>(&m))
        sent.push_back(*detections);
    };
  }
  DetectorNode node;
  std::vector<detection::Detections> sent;
  std::vector<std::vector<std::uint8_t>> all;  ///< bytes of everything sent, in order
};

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

// A robot that stands on a slope of 20 %: its scans wait for their IMU, whenever that comes.
TEST(DetectorNode, LevelsScansWhateverArrivesFirst) {
  io::Config config;
  config.camera.enabled = false;
  config.laser.height_m = 0.3;
  std::vector<std::vector<std::uint8_t>> reference;
  std::mt19937 random(5);
  for (int round = 0; round < 8; ++round) {
    std::vector<bus::Message> scans, samples;
    for (int i = 0; i < 6; ++i) scans.emplace_back(scan(i));
    for (int i = 0; i < 80; ++i) {
      pose::Imu imu;
      imu.utime = 1'000'000 + 10'000 * i;
      imu.seq = i;
      imu.has_orientation = true;
      imu.pitch_rad = -0.2;
      samples.emplace_back(imu);
    }
    Bench bench(config);
    std::size_t next_scan = 0, next_sample = 0;
    while (next_scan < scans.size() || next_sample < samples.size()) {
      // up to 0.2 s apart
      const bool may_scan = next_scan < scans.size() && 10 * next_scan < next_sample + 20;
      const bool may_sample = next_sample < samples.size() && next_sample < 10 * next_scan + 20;
      if (may_scan && (!may_sample || random() % 2 == 0)) {
        bench.handle(scans[next_scan++]);
      } else {
        bench.handle(samples[next_sample++]);
      }
    }
    bench.flush();
    if (round == 0) reference = bytes_of(bench.sent);
    EXPECT_EQ(bytes_of(bench.sent), reference);
    ASSERT_EQ(bench.sent.size(), 6u);
    EXPECT_EQ(bench.node.warning(), "");
  }
  Bench level(config);
  for (int i = 0; i < 6; ++i) level.handle(scan(i));
  level.flush();
  ASSERT_EQ(level.sent.size(), 6u);
  EXPECT_NE(bytes_of(level.sent), reference);
  EXPECT_NE(level.node.warning().find("laser.height_m"), std::string::npos);
}

/// R_level_base of a robot that pitches and rolls.
Eigen::Matrix3d tilted_by(double pitch_rad, double roll_rad) {
  return (Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// What a tilted scanner measures of upright tubes, whose places are in a level frame about it.
laser::Scan tilted_scan(const std::vector<test::Tube>& tubes, const Eigen::Matrix3d& R) {
  laser::Scan scan = test::scan_of({});
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
    const Eigen::Vector3d ray =
        R * Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0);
    double range_m = 0.0;
    for (const test::Tube& tube : tubes) {
      range_m = std::max(range_m, test::hit_m(tube, std::atan2(ray.y(), ray.x())));
    }
    scan.ranges_m[i] = static_cast<float>(range_m / ray.head<2>().norm());
  }
  return scan;
}

// Upright trunks of 0.09 m lean in the picture of a tilted robot, and stand beside where a level
// one would see them: both their edges are found all the same, and their widths by them.
TEST(DetectorNode, WindowsOfPicturesFollowRollAndPitch) {
  io::Config config;
  config.laser.height_m = 1.0;
  auto& lens = config.camera.intrinsics;
  constexpr int kSharp = 4;
  lens.width_px *= kSharp, lens.height_px *= kSharp;
  for (const std::size_t i : {0u, 1u}) lens.fc_px[i] *= kSharp, lens.cc_px[i] *= kSharp;
  const double pitch_rad = -0.12, roll_rad = 0.245;
  const Eigen::Matrix3d R = tilted_by(pitch_rad, roll_rad);
  for (const double y_m : {-0.6, -0.55, -0.5}) {
    const std::vector<test::Tube> tubes{test::brown_tube(1.5, y_m)};
    Bench bench(config);
    for (int i = 0; i < 30; ++i) {
      pose::Imu imu;
      imu.utime = 900'000 + 10'000 * i;
      imu.seq = i;
      imu.has_orientation = true;
      imu.pitch_rad = pitch_rad;
      imu.roll_rad = roll_rad;
      bench.handle(imu);
    }
    bench.handle(tilted_scan(tubes, R));
    bench.handle(test::picture_of_tubes(tubes, {config.laser, config.camera, config.detector},
                                        1'000'000, R));
    bench.flush();
    ASSERT_EQ(bench.sent.size(), 1u);
    ASSERT_EQ(bench.sent[0].trunks.size(), 1u);
    const detection::Detection& trunk = bench.sent[0].trunks[0];
    EXPECT_EQ(trunk.label, Label::kTree);
    EXPECT_GT(trunk.roc_edges, 0.9f) << y_m;
    EXPECT_NEAR(trunk.width_m, 0.09, 0.003) << y_m;
  }
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
  warning = bus::warning_text(bench.node);
  bench.flush();
  EXPECT_EQ(bus::warning_text(bench.node).empty(), warning.empty());
  return bench.sent;
}

TEST(DetectorNode, WarnsOfACameraThatIsTurned) {
  std::string warning;
  for (const double turned_rad : {0.04, -0.04}) {  // beyond the detector's own windows
    watch({}, turned_rad, warning);
    double offset_deg = 0.0;
    ASSERT_EQ(std::sscanf(warning.c_str(), "the pictures lie %lf degrees", &offset_deg), 1)
        << warning;
    EXPECT_NEAR(offset_deg, 0.04 * 180.0 / geometry::kPi, 0.4);
    EXPECT_NE(warning.find("camera.phi_rad"), std::string::npos) << warning;
  }
  watch({}, 0.0, warning);
  EXPECT_EQ(warning, "");
}

/// The first pair of a second is looked at by CameraCheck, the others are not.
TEST(DetectorNode, LookingAtTheEdgesDoesNotTouchDetections) {
  const std::vector<test::Tube> tubes{test::brown_tube(1.7, 0.3), test::brown_tube(1.9, -0.35)};
  const detection::Rig rig = test::tube_rig();
  detection::ScanImagePair pair;
  pair.scan = test::scan_of(tubes);
  pair.image = std::make_shared<vision::Image>(test::picture_of_tubes(tubes, rig));
  const JudgedPair looked = judge_pair(detection::find_by_laser(pair.scan, rig), pair, rig, true);
  const JudgedPair judged = judge_pair(detection::find_by_laser(pair.scan, rig), pair, rig, false);
  EXPECT_TRUE(looked.sight);
  EXPECT_FALSE(judged.sight);
  EXPECT_EQ(bytes_of({looked.result.detections}), bytes_of({judged.result.detections}));
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

/// What a drive gives when all that can be foreseen is computed ahead of its turn by `ahead`
/// inputs, and how many inputs gave something to compute.
std::pair<std::vector<std::vector<std::uint8_t>>, int> sent_ahead(
    const io::Config& config, const std::vector<bus::Message>& inputs, std::size_t ahead) {
  Bench bench(config);
  std::deque<std::unique_ptr<bus::Precomputation>> precomputed;
  int num_pairs = 0;
  for (std::size_t i = 0, next = 0; i < inputs.size(); ++i) {
    for (; next < inputs.size() && next <= i + ahead; ++next) {
      precomputed.push_back(bench.node.precompute(inputs[next]));
      if (!precomputed.back()) continue;
      precomputed.back()->compute();
      const auto& detections = dynamic_cast<const PrecomputedDetections&>(*precomputed.back());
      num_pairs += static_cast<int>(detections.pairs.size()) + (detections.alone ? 1 : 0);
    }
    bench.node.use_precomputed(std::move(precomputed.front()));
    precomputed.pop_front();
    bench.handle(inputs[i]);
  }
  bench.flush();
  bench.all.push_back({});
  for (const char c : bench.node.warning()) {
    bench.all.back().push_back(static_cast<std::uint8_t>(c));
  }
  return {bench.all, num_pairs};
}

std::vector<std::vector<std::uint8_t>> sent_in_turn(const io::Config& config,
                                                    const std::vector<bus::Message>& inputs) {
  Bench bench(config);
  for (const bus::Message& input : inputs) bench.handle(input);
  bench.flush();
  bench.all.push_back({});
  for (const char c : bench.node.warning()) {
    bench.all.back().push_back(static_cast<std::uint8_t>(c));
  }
  return bench.all;
}

TEST(DetectionPrecomputer, WhatIsComputedAheadChangesNothing) {
  std::vector<bus::Message> inputs;
  for (int i = 0; i < 40; ++i) {
    inputs.push_back(scan(i));
    if (i % 7 == 3) continue;  // without a picture
    vision::Image image = picture(i);
    if (i == 20) image.data.resize(100);
    inputs.push_back(pose::Odometry{image.utime - 3000, i, 0.3, 0.02 * i, {}});
    inputs.push_back(std::move(image));
  }
  io::Config alone;
  alone.camera.enabled = false;
  io::Config moving;
  moving.detector.use_odometry = true;
  for (const io::Config& config : {io::Config{}, alone, moving}) {
    const auto expected = sent_in_turn(config, inputs);
    for (const std::size_t ahead : {std::size_t{0}, std::size_t{5}, std::size_t{1000}}) {
      const auto [sent, num_pairs] = sent_ahead(config, inputs, ahead);
      EXPECT_EQ(sent, expected);
      EXPECT_GT(num_pairs, 30u);
    }
  }
}

}  // namespace
}  // namespace orchard::procs
