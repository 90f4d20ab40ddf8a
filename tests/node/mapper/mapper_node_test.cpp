// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper_node.hpp"

#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "bus/messages/codec.hpp"
#include "geometry/angles.hpp"
#include "node/mapper/row_drive.hpp"

namespace orchard::procs {
namespace {

constexpr std::int64_t kStart_us = 1000000;

pose::PoseEstimate pose_at(int k, std::int64_t utime) {
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.seq = k;
  pose.x_m = 1e-6 * static_cast<double>(utime - kStart_us);
  return pose;
}

detection::Detections scan_at(int k, std::int64_t utime) {
  detection::Detections detections;
  detections.utime = utime;
  detections.seq = k;
  for (int tree = 0; tree < 4; ++tree) {
    detection::Detection d;
    d.centre_x_m = tree - 1e-6 * static_cast<double>(utime - kStart_us) + 0.001 * (k % 5);
    d.centre_y_m = 1.0;
    d.covariance = {1e-4, 0, 1e-4};
    d.width_m = 0.09;
    d.width_sd_m = 0.01;
    d.label = detection::Label::kTree;
    d.roc_tree = 0.9f;
    detections.trunks.push_back(d);
  }
  return detections;
}

std::vector<std::vector<std::uint8_t>> run(const std::vector<bus::Message>& inputs) {
  MapperNode node{io::Config{}};
  std::vector<std::vector<std::uint8_t>> out;
  const bus::Outbox send = [&](bus::Message m) { out.push_back(bus::encode(m)); };
  for (const bus::Message& input : inputs) node.handle(input, send);
  node.flush(send);
  EXPECT_EQ(node.counts().num_late, 0);
  EXPECT_EQ(node.landmarks().size(), 4u);
  EXPECT_EQ(node.content({}).trajectory.size(), 30u);
  return out;
}

TEST(MapperNode, TheOrderOfArrivalBetweenChannelsDoesNotMatter) {
  std::vector<bus::Message> poses, scans;
  for (int k = 0; k < 30; ++k) {
    poses.push_back(pose_at(k, kStart_us + 100000 * k));
    scans.push_back(scan_at(k, kStart_us + 100000 * k - 30000 * (k > 0)));
  }
  const auto merge = [&](const std::vector<bool>& pose_first) {
    std::vector<bus::Message> all;
    std::size_t p = 0, s = 0;
    for (const bool is_pose : pose_first) {
      all.push_back(is_pose ? poses[p++] : scans[s++]);
    }
    return all;
  };
  std::vector<bool> order(60, false);
  std::fill(order.begin(), order.begin() + 30, true);
  const auto expected = run(merge(order));
  std::mt19937_64 bits(3);
  for (int round = 0; round < 50; ++round) {
    for (std::size_t i = order.size() - 1; i > 0; --i) {
      const std::size_t j = bits() % (i + 1);
      const bool held = order[i];
      order[i] = order[j];
      order[j] = held;
    }
    EXPECT_EQ(run(merge(order)), expected);
  }
}

TEST(MapperNode, WaitsForAPoseAndGivesUpByMessageTime) {
  io::Config config;
  config.mapper.pose_wait_s = 1.0;
  config.mapper.existence.scan_wait_s = 0.0;
  MapperNode node(config);
  int num_tiles = 0;
  const bus::Outbox send = [&](const bus::Message&) { ++num_tiles; };
  node.handle(pose_at(0, kStart_us - 100000), send);  // the first of all is waited for longer
  node.handle(scan_at(0, kStart_us), send);
  EXPECT_EQ(num_tiles, 0);
  EXPECT_NE(node.waiting_for().find("POSE"), std::string::npos);
  node.handle(scan_at(1, kStart_us + 2000000), send);
  EXPECT_EQ(node.counts().num_late, 1);
  node.handle(pose_at(0, kStart_us + 1900000), send);
  EXPECT_EQ(num_tiles, 0);
  node.handle(pose_at(1, kStart_us + 2100000), send);
  EXPECT_EQ(num_tiles, 1);
  EXPECT_TRUE(node.waiting_for().empty());
  node.handle(scan_at(2, kStart_us), send);
  EXPECT_EQ(node.counts().num_late, 2);
}

TEST(MapperNode, TheFirstPoseOfAllIsWaitedForAMinute) {
  io::Config config;
  config.mapper.pose_wait_s = 1.0;
  config.mapper.existence.scan_wait_s = 0.0;
  MapperNode node(config);
  int num_tiles = 0;
  const bus::Outbox send = [&](const bus::Message&) { ++num_tiles; };
  for (int i = 0; i <= 700; ++i) node.handle(scan_at(i, kStart_us + 100000 * i), send);
  EXPECT_EQ(node.counts().num_late, 100) << "of the first ten seconds of seventy";
  for (int i = 0; i <= 700; ++i) node.handle(pose_at(i, kStart_us + 100000 * i), send);
  EXPECT_EQ(num_tiles, 601);
}

/// The robot stands at the origin before four trees in an arc; somebody stands among them until
/// 1.2 s. Half a second later nobody is there.
struct StandingDrive {
  std::vector<bus::Message> poses, scans, detections;
};

StandingDrive standing_drive() {
  StandingDrive drive;
  for (int k = 0; k < 60; ++k) {
    const std::int64_t utime = kStart_us + 100000 * k;
    pose::PoseEstimate pose;
    pose.utime = utime;
    pose.seq = k;
    drive.poses.emplace_back(pose);
    laser::Scan scan;
    scan.utime = utime;
    scan.seq = k;
    scan.bearing_step_rad = 0.006;
    scan.bearing_min_rad = -1.5;
    scan.beam_period_us = 40.0;
    scan.range_max_m = 20.0;
    scan.ranges_m.assign(501, 9.0f);
    detection::Detections detections = scan_at(k, utime);
    detections.trunks.resize(k < 12 ? 4 : 3);
    for (std::size_t i = 0; i < detections.trunks.size(); ++i) {
      const double bearing_rad = -0.6 + 0.4 * static_cast<double>(i);
      detections.trunks[i].utime = utime + 5000 * static_cast<std::int64_t>(i);
      detections.trunks[i].centre_x_m = 3.0 * std::cos(bearing_rad);
      detections.trunks[i].centre_y_m = 3.0 * std::sin(bearing_rad);
      for (int beam = -3; beam <= 3; ++beam) {
        scan.ranges_m[static_cast<std::size_t>((bearing_rad + 1.5) / 0.006 + beam + 0.5)] = 2.955f;
      }
    }
    drive.scans.emplace_back(std::move(scan));
    drive.detections.emplace_back(std::move(detections));
  }
  return drive;
}

TEST(MapperNode, BeamsDropWhatLeftWheneverTheyArrive) {
  const StandingDrive drive = standing_drive();
  std::vector<std::vector<std::uint8_t>> expected;
  std::mt19937_64 bits(5);
  for (int round = 0; round < 40; ++round) {
    MapperNode node{io::Config{}};
    EXPECT_EQ(node.inputs().back(), bus::Channel::kScan);
    std::vector<std::vector<std::uint8_t>> out;
    const bus::Outbox send = [&](const bus::Message& m) { out.push_back(bus::encode(m)); };
    // each channel by itself up to 0.9 s ahead of the others
    const std::array<const std::vector<bus::Message>*, 3> channels{&drive.poses, &drive.scans,
                                                                   &drive.detections};
    std::array<std::size_t, 3> next{};
    while (next != std::array<std::size_t, 3>{60, 60, 60}) {
      const std::size_t one = bits() % 3;
      const std::size_t least = *std::min_element(next.begin(), next.end());
      if (next[one] == 60 || next[one] > least + 8) continue;
      node.handle((*channels[one])[next[one]++], send);
    }
    node.flush(send);
    EXPECT_EQ(node.landmarks().size(), 3u);
    EXPECT_EQ(node.counts().num_late, 0);
    if (round == 0) expected = out;
    EXPECT_EQ(out, expected) << "round " << round;
  }
}

TEST(MapperNode, WithoutScansItWaitsOnceAndSaysSo) {
  const StandingDrive drive = standing_drive();
  io::Config config;
  config.mapper.existence.scan_wait_s = 0.5;
  config.mapper.deskew_pose_gap_max_s = 0.0;  // nor for the pose of the last beam
  MapperNode node{config};
  int num_tiles = 0;
  const bus::Outbox send = [&](const bus::Message&) { ++num_tiles; };
  for (std::size_t k = 0; k < 20; ++k) {
    node.handle(drive.poses[k], send);
    node.handle(drive.detections[k], send);
    EXPECT_EQ(num_tiles, k < 6 ? 0 : static_cast<int>(k) + 1);
    EXPECT_NE(node.waiting_for().find("SCAN"), std::string::npos);
  }
  // from when it is heard, it is waited for again
  node.handle(drive.scans[20], send);
  EXPECT_EQ(node.waiting_for(), "");
  node.handle(drive.poses[21], send);
  node.handle(drive.detections[21], send);
  EXPECT_EQ(num_tiles, 20);
  node.handle(drive.scans[21], send);
  EXPECT_EQ(num_tiles, 21);
}

TEST(MapperNode, ARigMayDoWithoutScans) {
  const StandingDrive drive = standing_drive();
  io::Config config;
  config.mapper.existence.scan_wait_s = 0.0;
  MapperNode node{config};
  const auto inputs = node.inputs();
  EXPECT_EQ(std::count(inputs.begin(), inputs.end(), bus::Channel::kScan), 0);
  int num_tiles = 0;
  const bus::Outbox send = [&](const bus::Message&) { ++num_tiles; };
  node.handle(drive.poses[0], send);
  node.handle(drive.detections[0], send);
  EXPECT_EQ(num_tiles, 1);
  EXPECT_EQ(node.waiting_for(), "");
}

TEST(MapperNode, TilesStayBelowTheSizeOfADatagram) {
  io::Config config;
  config.mapper.existence.scan_wait_s = 0.0;
  MapperNode node{config};
  std::size_t largest = 0;
  std::size_t num_landmarks = 0;
  const bus::Outbox send = [&](const bus::Message& m) {
    largest = std::max(largest, bus::encode(m).size());
    num_landmarks += std::get<mapping::MapTile>(m).landmarks.size();
  };
  detection::Detections many = scan_at(0, kStart_us);
  many.trunks.assign(1200, many.trunks.front());
  for (std::size_t i = 0; i < many.trunks.size(); ++i) {
    many.trunks[i].centre_x_m = static_cast<double>(i % 40);
    many.trunks[i].centre_y_m = static_cast<double>(i / 40);
  }
  node.handle(many, send);
  node.handle(pose_at(0, kStart_us), send);
  EXPECT_EQ(num_landmarks, 1200u);
  EXPECT_LT(largest, 60000u);
}

/// A drive past the trees that drifts to the side by 0.2 m/s; at every tenth scan the past is
/// corrected, and poses from then on start from there.
struct CorrectedDrive {
  std::vector<bus::Message> pose_messages;  ///< POSE and TRAJECTORY in the order of their sender
  std::vector<bus::Message> scans;
  std::int32_t num_revisions = 0;
};

CorrectedDrive corrected_drive() {
  CorrectedDrive drive;
  std::int32_t page_seq = 0;
  for (int k = 0; k < 30; ++k) {
    const std::int64_t utime = kStart_us + 100000 * k;
    if (k % 10 == 9) {
      pose::Trajectory trajectory;
      trajectory.utime = utime;
      trajectory.revision = ++drive.num_revisions;
      for (int i = 0; i < k; i += 2) {
        trajectory.poses.push_back(pose_at(0, kStart_us + 100000 * i));
      }
      for (pose::TrajectoryPage& page : pose::paginate(trajectory, 4)) {
        page.seq = page_seq++;
        drive.pose_messages.emplace_back(std::move(page));
      }
    }
    pose::PoseEstimate pose = pose_at(k, utime);
    pose.y_m = 0.02 * ((k + 1) % 10);
    pose.covariance = {1e-2, 0, 0, 1e-2, 0, 1e-6};
    drive.pose_messages.emplace_back(pose);
    drive.scans.emplace_back(scan_at(k, utime));
  }
  return drive;
}

TEST(MapperNode, ACorrectedPastMovesTheLandmarksAndThePath) {
  const CorrectedDrive drive = corrected_drive();
  MapperNode node{io::Config{}};
  const bus::Outbox send = [](const bus::Message&) {};
  for (const bus::Message& scan : drive.scans) node.handle(scan, send);
  for (const bus::Message& message : drive.pose_messages) node.handle(message, send);
  node.flush(send);
  const std::vector<mapping::Landmark> landmarks = node.landmarks();
  ASSERT_EQ(landmarks.size(), 4u);
  for (const mapping::Landmark& l : landmarks) EXPECT_NEAR(l.y_m, 1.0, 0.003);
  const auto path = node.content({}).trajectory;
  ASSERT_EQ(path.size(), 30u);
  for (const pose::PoseEstimate& pose : path) EXPECT_NEAR(pose.y_m, 0.0, 0.021);  // corrected at 28
  EXPECT_EQ(node.counts().num_unusable, 0);
}

TEST(MapperNode, WhenACorrectionArrivesBesideTheScansDoesNotMatter) {
  const CorrectedDrive drive = corrected_drive();
  std::vector<std::vector<std::uint8_t>> expected;
  std::mt19937_64 bits(9);
  for (int round = 0; round < 30; ++round) {
    MapperNode node{io::Config{}};
    std::vector<std::vector<std::uint8_t>> out;
    const bus::Outbox send = [&](const bus::Message& m) { out.push_back(bus::encode(m)); };
    std::size_t p = 0, s = 0;
    while (p < drive.pose_messages.size() || s < drive.scans.size()) {
      const bool pose_next = s == drive.scans.size() ||
                             (p < drive.pose_messages.size() && bits() % 3 < 1 + bits() % 2);
      node.handle(pose_next ? drive.pose_messages[p++] : drive.scans[s++], send);
    }
    node.flush(send);
    if (round == 0) expected = out;
    EXPECT_EQ(out, expected) << "round " << round;
  }
}

/// A robot that stands. While it sweeps, the whole past is found to be turned by a quarter: poses
/// from then on are told so.
TEST(MapperNode, ACorrectionInTheMiddleOfASweepTearsNothingApart) {
  constexpr std::int64_t kCorrected_us = kStart_us + 205000;
  const auto pose_of = [](int k, bool corrected) {
    pose::PoseEstimate pose;
    pose.utime = kStart_us + 10000 * k;
    pose.seq = k;
    pose.yaw_rad = corrected ? geometry::kPi / 2.0 : 0.0;
    return pose;
  };
  io::Config config;
  config.mapper.existence.scan_wait_s = 0.0;
  MapperNode node{config};
  const bus::Outbox send = [](const bus::Message&) {};
  for (int k = 0; k < 40; ++k) {
    if (kStart_us + 10000 * k > kCorrected_us && kStart_us + 10000 * (k - 1) < kCorrected_us) {
      pose::Trajectory trajectory;
      trajectory.utime = kCorrected_us;
      trajectory.revision = 1;
      for (int i = 0; i < k; i += 5) trajectory.poses.push_back(pose_of(i, true));
      for (pose::TrajectoryPage& page : pose::paginate(trajectory)) node.handle(page, send);
    }
    node.handle(pose_of(k, kStart_us + 10000 * k > kCorrected_us), send);
  }
  detection::Detections sweep = scan_at(0, kStart_us + 200000);
  for (std::size_t i = 0; i < sweep.trunks.size(); ++i) {
    sweep.trunks[i].centre_x_m = 5.0 + 2.0 * static_cast<double>(i);
    sweep.trunks[i].utime = sweep.utime + 20000 * static_cast<std::int64_t>(i);
  }
  node.handle(sweep, send);
  node.flush(send);
  const std::vector<mapping::Landmark> landmarks = node.landmarks();
  ASSERT_EQ(landmarks.size(), 4u);
  for (const mapping::Landmark& l : landmarks) {
    EXPECT_NEAR(l.x_m, -1.0, 1e-6);
    EXPECT_NEAR(l.y_m, 5.0 + 2.0 * (l.id - 1), 1e-6);
  }
}

TEST(MapperNode, SatelliteFixesSayWhereTheMapLies) {
  // Map's x axis points north; its origin lies 100 m east of the datum.
  io::Config config;
  config.pose.gnss.datum = {-27.6, 151.9, 600.0};
  const GeographicLib::LocalCartesian enu(-27.6, 151.9, 600.0);
  MapperNode node{config};
  const bus::Outbox send = [](const bus::Message&) {};
  for (int k = 0; k < 300; ++k) {
    const std::int64_t utime = kStart_us + 100000 * k;
    node.handle(pose_at(k, utime), send);
    pose::Gnss gnss;
    gnss.utime = utime;
    gnss.seq = k;
    gnss.fix_quality = 4;
    enu.Reverse(100.0, 0.1 * k, 0.0, gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m);
    node.handle(gnss, send);
  }
  node.flush(send);
  const auto place = node.content({}).georeference;
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->x_m, 100.0, 1e-3);
  EXPECT_NEAR(place->y_m, 0.0, 1e-3);
  EXPECT_NEAR(place->yaw_rad, 1.5707963, 1e-5);
  EXPECT_LT(place->residual_rms_m, 1e-3);
  EXPECT_EQ(node.warning(), "");
  EXPECT_TRUE(node.findings().empty());
}

TEST(MapperNode, APathBesideItsFixesIsDoubtedLiveAndInTheMap) {
  MapperNode node{io::Config{}};
  drive_beside_fixes(node);
  const auto is_doubted = [](const std::vector<Finding>& findings) {
    return findings.size() == 1 && findings[0].name == "path_contradicts_fixes";
  };
  EXPECT_TRUE(is_doubted(node.findings())) << "while it drives";
  node.flush([](const bus::Message&) {});
  EXPECT_TRUE(is_doubted(node.findings()));
  EXPECT_TRUE(is_doubted(node.content({}).summary.quality));
}

TEST(MapperNode, AltitudesGiveTheTreesTheHeightOfTheirGround) {
  io::Config config;
  config.pose.gnss.datum = {-27.6, 151.9, 600.0};
  config.pose.gnss.antenna_height_m = 1.5;
  for (const bool has_altitude : {true, false}) {
    const GeographicLib::LocalCartesian enu(-27.6, 151.9, 600.0);
    MapperNode node{config};
    const bus::Outbox nobody = [](const bus::Message&) {};
    for (int k = 0; k < 240; ++k) {  // 24 m up a slope of 10 %
      const std::int64_t utime = kStart_us + 100000 * k;
      node.handle(pose_at(k, utime), nobody);
      node.handle(scan_at(k, utime), nobody);
      pose::Gnss gnss;
      gnss.utime = utime;
      gnss.seq = k;
      gnss.fix_quality = 4;
      enu.Reverse(0.1 * k, 0.0, 0.01 * k + 1.5, gnss.latitude_deg, gnss.longitude_deg,
                  gnss.altitude_m);
      gnss.covariance = {4e-4, 0, 0,
                         4e-4, 0, has_altitude ? 16e-4 : pose::kUnknownAltitudeVariance_m2};
      node.handle(gnss, nobody);
    }
    node.flush(nobody);
    ASSERT_EQ(node.finished().landmarks.size(), 4u);
    for (const mapping::Landmark& l : node.finished().landmarks) {
      EXPECT_EQ(l.z_sd_m > 0.0, has_altitude);
      EXPECT_NEAR(l.z_m, has_altitude ? 0.1 * l.x_m : 0.0, 0.03);
      EXPECT_LT(l.z_sd_m, 0.25);  // a metre beside the path, without a tilt
    }
  }
}

/// A reflector flashes in half of the observations or more, bark in hardly any: a sixth is neither.
TEST(MapperNode, SaysWhereReflectorsDoNotTell) {
  for (const int period : {1, 2, 6}) {
    io::Config config;
    config.detector.segmentation.reflector = laser::ReflectorUse::kOnly;
    MapperNode node(config);
    const bus::Outbox nobody = [](const bus::Message&) {};
    for (int k = 0; k < 60; ++k) {
      detection::Detections detections = scan_at(k, kStart_us + 100000 * k);
      for (detection::Detection& d : detections.trunks) {
        d.label = k % period == 0 ? detection::Label::kTree : detection::Label::kObject;
      }
      node.handle(pose_at(k, detections.utime), nobody);
      node.handle(detections, nobody);
    }
    node.flush(nobody);
    const bool is_said =
        node.warning().find("4 of 4 landmarks with a reflector") != std::string::npos;
    EXPECT_EQ(is_said, period == 6) << period << ": " << node.warning();
  }
}

}  // namespace
}  // namespace orchard::procs
