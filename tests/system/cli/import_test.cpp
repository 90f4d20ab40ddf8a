// SPDX-License-Identifier: BSD-3-Clause
// A robot that speaks libbot's types makes the map that the simulator's own messages make.
// From a rawlog to a map: the simulated drive is written as a robot under MRPT would have.
#include <gmock/gmock.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CRawlog.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "bot_core/image_t.hpp"
#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"
#include "io/log/log_writer.hpp"
#include "io/map/map_csv.hpp"
#include "io/recording/truth_csv.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;

class ImportCommand : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    std::filesystem::create_directory(path("drive"));
    write_file(path("drive/sensors.yaml"),
               "laser:\n  num_beams: 3\n  bearing_min_rad: -0.1\n  bearing_step_rad: 0.1\n"
               "  range_min_m: 0.1\n  range_max_m: 5\n"
               "  mount: {x_m: 0.25, y_m: 0, yaw_rad: 0}\n");
    write_file(path("drive/scans.csv"), "utime_us,r0,r1,r2\n1000000,1,2,0\n1100000,1,2,3\n");
    write_file(path("drive/poses.csv"), "utime_us,x_m,y_m,yaw_rad\n1000000,0,0,0\n");
  }
  Result import() const { return orchard({"import", path("drive"), "--out", path("drive.lcm")}); }
};

TEST_F(ImportCommand, AFolderBecomesALog) {
  const Result result = import();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 messages"));
  EXPECT_THAT(result.out, HasSubstr("mount_x_m: 0.25"));
  EXPECT_EQ(num_messages(path("drive.lcm"), "SCAN"), 2);
  EXPECT_EQ(num_messages(path("drive.lcm"), "POSE_FIX"), 1);
  EXPECT_EQ(orchard({"log", "check", path("drive.lcm")}).exit_code, 0);
}

TEST_F(ImportCommand, ScansThatRepeatTheOneBeforeAreLeftOutAndCounted) {
  std::string names = "utime_us", here, there, few;
  for (int beam = 0; beam < 25; ++beam) {
    names += ",r" + std::to_string(beam);
    here += "," + std::to_string(1 + 0.1 * beam);
    there += "," + std::to_string(1.1 + 0.1 * beam);
    few += beam < 3 ? ",1" : ",0";
  }
  write_file(path("drive/sensors.yaml"),
             "laser:\n  num_beams: 25\n  bearing_min_rad: -0.1\n  bearing_step_rad: 0.01\n"
             "  range_min_m: 0.1\n  range_max_m: 5\n");
  write_file(path("drive/scans.csv"), names + "\n1000000" + here + "\n1100000" + here +
                                          "\n1200000" + there + "\n1300000" + few + "\n1400000" +
                                          few + "\n1500000" + there + "\n1600000" + there + "\n");
  const Result result = import();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("left out: 2 scans that repeat"));
  EXPECT_EQ(num_messages(path("drive.lcm"), "SCAN"), 5);  // a few returns may agree by chance
  EXPECT_EQ(orchard({"log", "check", path("drive.lcm")}).exit_code, 0);  // no gap in the numbers
}

TEST_F(ImportCommand, MistakesAreNamedAndNoLogIsLeft) {
  write_file(path("drive/scans.csv"), "utime_us,r0,r1,r2\n1000000,1,2,0\n1100000,1,two,3\n");
  const Result result = import();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("scans.csv:3"));
  EXPECT_EQ(count_lines(result.err), 1) << result.err;
  EXPECT_FALSE(exists(path("drive.lcm")));
}

TEST_F(ImportCommand, WhatIsNeitherFolderNorRawlogIsRefused) {
  write_file(path("noise.rawlog"), std::string(3000, 'x'));
  for (const char* name : {"noise.rawlog", "none.rawlog"}) {
    const Result result = orchard({"import", path(name), "--out", path("drive.lcm")});
    EXPECT_EQ(result.exit_code, 3) << name;
    EXPECT_THAT(result.err, HasSubstr(name));
    EXPECT_FALSE(exists(path("drive.lcm")));
  }
}

// Eight seconds of the simulated orchard (tests/data/make_row.sh), so that no checkout is without a
// recording: every trunk that the robot passed or came near is on the map, once, where it stands.
TEST_F(ImportCommand, TheRowOfThisRepositoryIsImportedAndMapped) {
  const std::string row = ORCHARD_SOURCE_DIR "/tests/data/row";
  ASSERT_EQ(orchard({"import", row, "--out", path("row.lcm")}).exit_code, 0);
  EXPECT_EQ(num_messages(path("row.lcm"), "SCAN"), 21);
  EXPECT_EQ(num_messages(path("row.lcm"), "IMAGE"), 10);
  EXPECT_EQ(num_messages(path("row.lcm"), "ODOMETRY"), 401);
  EXPECT_EQ(num_messages(path("row.lcm"), "POSE_FIX"), 81);
  const Result result = orchard({"map", path("row.lcm"), "--config",
                                 ORCHARD_SOURCE_DIR "/config/orchard.yaml", "--out", path("map")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto landmarks = io::read_map_csv(path("map/map.csv"));
  int num_judged = 0;
  for (const simulation::TruthObject& thing : io::read_truth_csv(row + "/truth.csv")) {
    if (thing.label != detection::Label::kTree || thing.y_m > 12.5) continue;
    int num_there = 0;
    for (const mapping::Landmark& l : landmarks) {
      if (std::hypot(l.x_m - thing.x_m, l.y_m - thing.y_m) > 0.05) continue;
      ++num_there;
      EXPECT_NEAR(l.width_m, thing.width_m, 0.015) << thing.x_m << ' ' << thing.y_m;
      EXPECT_NE(l.label, detection::Label::kObject) << thing.x_m << ' ' << thing.y_m;
    }
    EXPECT_EQ(num_there, 1) << thing.x_m << ' ' << thing.y_m;
    ++num_judged;
  }
  EXPECT_EQ(num_judged, 9);
}

template <class M>
void write(io::LogWriter& writer, const std::string& channel, const M& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  writer.write(message.utime, channel, bytes);
}

/// The log as a robot with libbot would have recorded it.
void write_as_libbot(const std::string& from_path, const std::string& to_path) {
  io::LogReader reader(from_path);
  io::LogWriter writer(to_path);
  while (const auto event = reader.next()) {
    const auto channel = bus::find_channel(event->channel);
    if (!channel || bus::info(*channel).role != bus::Role::kSource) continue;
    const auto decoded = bus::decode(*channel, event->data.data(), event->data.size());
    const auto& message = std::get<bus::Message>(decoded);
    if (const auto* scan = std::get_if<laser::Scan>(&message)) {
      bot_core::planar_lidar_t lidar;
      lidar.utime = scan->utime;
      lidar.nranges = static_cast<int>(scan->ranges_m.size());
      lidar.ranges = scan->ranges_m;
      lidar.nintensities = 0;
      lidar.rad0 = static_cast<float>(scan->bearing_min_rad);
      lidar.radstep = static_cast<float>(scan->bearing_step_rad);
      write(writer, "HOKUYO", lidar);
    } else if (const auto* image = std::get_if<vision::Image>(&message)) {
      bot_core::image_t picture;
      picture.utime = image->utime;
      picture.width = image->width_px;
      picture.height = image->height_px;
      picture.row_stride = 0;
      picture.pixelformat = 1196444237;  // MJPG
      picture.size = static_cast<int>(image->data.size());
      picture.data = image->data;
      picture.nmetadata = 0;
      write(writer, "CAMERA", picture);
    } else if (const auto* fix = std::get_if<pose::PoseFix>(&message)) {
      bot_core::pose_t pose{};
      pose.utime = fix->utime;
      pose.pos[0] = fix->x_m;
      pose.pos[1] = fix->y_m;
      pose.orientation[0] = std::cos(fix->yaw_rad / 2);
      pose.orientation[3] = std::sin(fix->yaw_rad / 2);
      write(writer, "POSE", pose);
    }
  }
  writer.close();
}

TEST_F(CliTest, ALogOfLibbotsTypesMakesTheSameMap) {
  const std::string ours = path("ours.lcm");
  ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--seed", "3", "--out", ours}).exit_code, 0);
  write_as_libbot(ours, path("robot.lcm"));
  const Result config = orchard({"log", "config", ours});
  ASSERT_EQ(config.exit_code, 0);
  std::string rig = config.out;
  const std::string by_default = "pose_as: odometry";
  ASSERT_NE(rig.find(by_default), std::string::npos);
  rig.replace(rig.find(by_default), by_default.size(), "pose_as: pose_fix");
  write_file(path("rig.yaml"), rig);
  const Result import = orchard(
      {"import", path("robot.lcm"), "--config", path("rig.yaml"), "--out", path("imported.lcm")});
  ASSERT_EQ(import.exit_code, 0) << import.err;
  for (const char* channel : {"SCAN", "IMAGE", "POSE_FIX"}) {
    EXPECT_EQ(num_messages(path("imported.lcm"), channel), num_messages(ours, channel)) << channel;
  }
  ASSERT_EQ(orchard({"map", ours, "--config", path("rig.yaml"), "--out", path("a")}).exit_code, 0);
  const Result mapped =
      orchard({"map", path("imported.lcm"), "--config", path("rig.yaml"), "--out", path("b")});
  ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
  const auto expected = io::read_map_csv(path("a/map.csv"));
  const auto found = io::read_map_csv(path("b/map.csv"));
  ASSERT_GT(expected.size(), 5u);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].label, expected[i].label);
    EXPECT_NEAR(found[i].x_m, expected[i].x_m, 0.005);
    EXPECT_NEAR(found[i].y_m, expected[i].y_m, 0.005);
  }
}

TEST_F(CliTest, ALogWithoutLibbotsTypesIsRefused) {
  const std::string ours = path("ours.lcm");
  ASSERT_EQ(orchard({"simulate", "--scene", "tubes", "--seed", "3", "--out", ours}).exit_code, 0);
  const Result import = orchard({"import", ours, "--out", path("imported.lcm")});
  EXPECT_EQ(import.exit_code, 3);
  EXPECT_THAT(import.err, HasSubstr("has no message of libbot's types"));
}

using namespace mrpt::obs;

constexpr std::int64_t kOdometryPeriod_us = 20000;
constexpr double kStep_m = 0.4;  // once a second, as config/tubes.yaml says

mrpt::system::TTimeStamp time_of(std::int64_t utime) {
  // MRPT counts tenths of microseconds since 1601
  return mrpt::system::TTimeStamp(
      mrpt::system::TTimeStamp::duration(utime * 10 + 116444736000000000));
}

CObservation2DRangeScan::Ptr to_mrpt(const laser::Scan& scan) {
  auto out = CObservation2DRangeScan::Create();
  out->timestamp = time_of(scan.utime);
  out->sensorLabel = "LASER";
  out->aperture =
      static_cast<float>(scan.bearing_step_rad * static_cast<double>(scan.ranges_m.size() - 1));
  out->maxRange = static_cast<float>(scan.range_max_m);
  out->sensorPose = mrpt::poses::CPose3D(0.12, 0, 0, 0, 0, 0);
  out->resizeScan(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    out->setScanRange(i, scan.ranges_m[i]);
    out->setScanRangeValidity(i, scan.ranges_m[i] > 0.0f);
  }
  return out;
}

CObservationImage::Ptr to_mrpt(const vision::Image& image) {
  auto out = CObservationImage::Create();
  out->timestamp = time_of(image.utime);
  out->sensorLabel = "CAMERA";
  out->image = mrpt::img::CImage(cv::imdecode(image.data, cv::IMREAD_COLOR), mrpt::img::DEEP_COPY);
  return out;
}

/// The way since the start of a robot that stands while it looks and goes on between.
double travelled_m(std::int64_t since_start_us) {
  if (since_start_us < 0) return 0.0;
  const double fraction = (static_cast<double>(since_start_us % 1000000) * 1e-6 - 0.4) / 0.4;
  return kStep_m * (static_cast<double>(since_start_us / 1000000) + std::clamp(fraction, 0.0, 1.0));
}

CObservationOdometry::Ptr odometry_at(std::int64_t start_utime, std::int64_t utime) {
  auto out = CObservationOdometry::Create();
  out->timestamp = time_of(utime);
  out->sensorLabel = "ODOMETRY";
  out->odometry = mrpt::poses::CPose2D(travelled_m(utime - start_utime), 0, 0);
  return out;
}

/// The scans and pictures of a log, and the odometry of the same drive.
void write_rawlog(const std::string& log_path, const std::string& rawlog_path) {
  CRawlog rawlog;
  io::LogReader reader(log_path);
  std::int64_t start_utime = 0;
  std::int64_t next_odometry = 0;
  while (const auto event = reader.next()) {
    const bus::Channel channel = *bus::find_channel(event->channel);
    if (bus::info(channel).role == bus::Role::kService) continue;  // the rig: no rawlog holds it
    const auto decoded = bus::decode(channel, event->data.data(), event->data.size());
    const auto& message = std::get<bus::Message>(decoded);
    const std::int64_t utime = bus::utime_of(message);
    if (start_utime == 0) {
      start_utime = utime;
      next_odometry = utime - 10 * kOdometryPeriod_us;
    }
    for (; next_odometry <= utime; next_odometry += kOdometryPeriod_us) {
      rawlog.insert(odometry_at(start_utime, next_odometry));
    }
    if (const auto* scan = std::get_if<laser::Scan>(&message)) rawlog.insert(to_mrpt(*scan));
    if (const auto* image = std::get_if<vision::Image>(&message)) rawlog.insert(to_mrpt(*image));
  }
  for (int i = 0; i < 10; ++i, next_odometry += kOdometryPeriod_us) {
    rawlog.insert(odometry_at(start_utime, next_odometry));
  }
  ASSERT_TRUE(rawlog.saveToRawLogFile(rawlog_path));
}

class RawlogToMap : public CliTest {};

TEST_F(RawlogToMap, FindsWhatStandsThere) {
  write_rawlog(log(), path("drive.rawlog"));
  const Result imported = orchard({"import", path("drive.rawlog"), "--out", path("drive.lcm")});
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_EQ(num_messages(path("drive.lcm"), "SCAN"), num_messages(log(), "SCAN"));
  EXPECT_EQ(num_messages(path("drive.lcm"), "IMAGE"), num_messages(log(), "IMAGE"));

  std::string rig = read_file(config());
  const std::size_t mode = rig.find("mode: fixes");
  ASSERT_NE(mode, std::string::npos);
  write_file(path("rig.yaml"), rig.replace(mode, 11, "mode: odometry"));
  const Result mapped =
      orchard({"map", path("drive.lcm"), "--config", path("rig.yaml"), "--out", path("map")});
  ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("16 landmarks: 12 trees in rows, 4 objects"));

  // Odometry alone begins at the origin looking along x; in the truth the robot looks along y.
  std::vector<simulation::TruthObject> objects = io::read_truth_csv(truth());
  for (simulation::TruthObject& object : objects) {
    const double x_m = object.x_m;
    object.x_m = object.y_m;
    object.y_m = -x_m;
  }
  io::write_truth_csv(path("truth.csv"), objects);
  const Result evaluated =
      orchard({"evaluate", path("map"), "--truth", path("truth.csv"), "--check"});
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.out << evaluated.err;
}

}  // namespace

}  // namespace orchard::cli_test
