// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/rawlog.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationBatteryState.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <opencv2/core.hpp>

#include "io/file_error.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using namespace mrpt::obs;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr std::int64_t kStart = 1700000000000000;

mrpt::system::TTimeStamp time_of(std::int64_t utime) {
  return mrpt::system::TTimeStamp(
      mrpt::system::TTimeStamp::duration(utime * 10 + 116444736000000000));
}

CObservation2DRangeScan::Ptr make_scan(std::int64_t utime) {
  auto scan = CObservation2DRangeScan::Create();
  scan->timestamp = time_of(utime);
  scan->sensorLabel = "LASER";
  scan->aperture = 2.0f;
  scan->maxRange = 5.0f;
  scan->sensorPose = mrpt::poses::CPose3D(0.25, 0, 0.4, 0, 0, 0);
  scan->resizeScanAndAssign(5, 1.5f, true);
  scan->setScanRangeValidity(2, false);
  return scan;
}

CObservationOdometry::Ptr make_odometry(std::int64_t utime, double x, double yaw) {
  auto odometry = CObservationOdometry::Create();
  odometry->timestamp = time_of(utime);
  odometry->odometry = mrpt::poses::CPose2D(x, 0, yaw);
  return odometry;
}

CRawlog make_observations() {
  CRawlog log;
  log.insert(make_odometry(kStart, 0, 0));
  log.insert(make_scan(kStart + 50000));
  log.insert(make_odometry(kStart + 100000, 0.05, 0));
  auto gps = CObservationGPS::Create();
  gps->timestamp = time_of(kStart + 60000);
  gnss::Message_NMEA_GGA gga;
  gga.fields.latitude_degrees = -32.5;
  gga.fields.longitude_degrees = -71.25;
  gga.fields.altitude_meters = 40;
  gga.fields.geoidal_distance = 2;
  gga.fields.fix_quality = 4;
  gps->setMsg(gga);
  log.insert(gps);
  auto image = CObservationImage::Create();
  image->timestamp = time_of(kStart + 70000);
  image->image =
      mrpt::img::CImage(cv::Mat(24, 32, CV_8UC3, cv::Scalar(10, 200, 30)), mrpt::img::DEEP_COPY);
  log.insert(image);
  auto battery = CObservationBatteryState::Create();
  battery->timestamp = time_of(kStart);
  log.insert(battery);
  return log;
}

void expect_observations(const RawlogContent& content) {
  ASSERT_THAT(content.messages, SizeIs(4));
  const auto& scan = std::get<laser::Scan>(content.messages[0]);
  EXPECT_EQ(scan.utime, kStart + 50000);
  EXPECT_EQ(scan.ranges_m, (std::vector<float>{1.5f, 1.5f, 0.0f, 1.5f, 1.5f}));
  EXPECT_DOUBLE_EQ(scan.bearing_min_rad, -1.0);
  EXPECT_DOUBLE_EQ(scan.bearing_step_rad, 0.5);
  const auto& gnss = std::get<pose::Gnss>(content.messages[1]);
  EXPECT_EQ(gnss.latitude_deg, -32.5);
  EXPECT_EQ(gnss.altitude_m, 42.0);
  EXPECT_EQ(gnss.fix_quality, 4);
  const auto& image = std::get<vision::Image>(content.messages[2]);
  EXPECT_EQ(image.width_px, 32);
  EXPECT_EQ(image.height_px, 24);
  const auto& odometry = std::get<pose::Odometry>(content.messages[3]);
  EXPECT_EQ(odometry.utime, kStart + 100000);
  EXPECT_NEAR(odometry.speed_mps, 0.5, 1e-9);
  ASSERT_TRUE(content.laser_mount.has_value());
  EXPECT_EQ(content.laser_mount->x_m, 0.25);
  EXPECT_EQ(content.ignored.size(), 2u);  // the battery, and the first odometry: no step yet
}

TEST(Rawlog, ObservationsAreRead) {
  const TestFolder folder;
  ASSERT_TRUE(make_observations().saveToRawLogFile(folder / "a.rawlog"));
  expect_observations(read_rawlog(folder / "a.rawlog"));
}

TEST(Rawlog, SensoryFramesWithIncrementsAreRead) {
  const TestFolder folder;
  CRawlog log;
  for (int i = 0; i < 3; ++i) {
    CActionRobotMovement2D movement;
    movement.timestamp = time_of(kStart + 200000 * i);
    movement.computeFromOdometry(mrpt::poses::CPose2D(0.1, 0, 0.02), {});
    CActionCollection actions;
    actions.insert(movement);
    log.insert(actions);
    CSensoryFrame frame;
    frame.insert(make_scan(kStart + 200000 * i + 10));
    log.insert(frame);
  }
  ASSERT_TRUE(log.saveToRawLogFile(folder / "a.rawlog"));
  const RawlogContent content = read_rawlog(folder / "a.rawlog");
  ASSERT_THAT(content.messages, SizeIs(5));
  const auto& odometry = std::get<pose::Odometry>(content.messages[1]);
  EXPECT_EQ(odometry.utime, kStart + 200000);
  EXPECT_NEAR(odometry.speed_mps, 0.5, 1e-9);
  EXPECT_NEAR(odometry.yaw_rate_radps, 0.1, 1e-9);
}

TEST(Rawlog, DamageIsAFileErrorOrAnotherValueButNeverACrash) {
  const TestFolder folder;
  const std::string path = folder / "plain.rawlog";
  {
    mrpt::io::CFileOutputStream file(path);
    auto archive = mrpt::serialization::archiveFrom(file);
    const CRawlog log = make_observations();
    for (std::size_t i = 0; i < log.size(); ++i) archive << *log.getAsGeneric(i);
  }
  expect_observations(read_rawlog(path));
  const std::string good = read_bytes(path);
  // A class name that became that of a class without objects: MRPT itself dies at it.
  std::string abstract = good;
  const std::size_t name = abstract.find("CObservationOdometry");
  ASSERT_NE(name, std::string::npos);
  const std::size_t length_at = abstract.rfind(static_cast<char>(0x80 | 20), name);
  if (length_at != std::string::npos) {
    abstract[length_at] = static_cast<char>(0x80 | 12);
    write_bytes(path, abstract);
    EXPECT_THROW(read_rawlog(path), FileError);
  }
  for (std::size_t at = 0; at < good.size(); at += good.size() / 60) {
    for (const char value : {'\x00', '\xFF'}) {
      std::string bad = good;
      bad[at] = value;
      write_bytes(path, bad);
      try {
        read_rawlog(path);
      } catch (const FileError&) {
      }
    }
  }
  for (std::size_t size = 0; size < good.size(); size += good.size() / 40) {
    write_bytes(path, good.substr(0, size));
    try {
      EXPECT_LT(read_rawlog(path).messages.size(), 4u) << size;
    } catch (const FileError&) {
    }
  }
}

TEST(Rawlog, ADamagedCompressedOneAndOthersAreRefused) {
  const TestFolder folder;
  ASSERT_TRUE(make_observations().saveToRawLogFile(folder / "a.rawlog"));
  std::string bad = read_bytes(folder / "a.rawlog");
  bad[bad.size() / 2] = static_cast<char>(bad[bad.size() / 2] ^ 4);
  write_bytes(folder / "bad.rawlog", bad);
  EXPECT_THROW(read_rawlog(folder / "bad.rawlog"), FileError);
  write_bytes(folder / "text.rawlog", "this is a text");
  EXPECT_THROW(read_rawlog(folder / "text.rawlog"), FileError);
  EXPECT_THROW(read_rawlog(folder / "missing.rawlog"), FileError);
}

}  // namespace
}  // namespace orchard::io
