// SPDX-License-Identifier: BSD-3-Clause
// From a rawlog to a map: the simulated drive is written as a robot under MRPT would have.
#include <gmock/gmock.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CRawlog.h>

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "bus/messages/codec.hpp"
#include "io/log/log_reader.hpp"
#include "io/recording/truth_csv.hpp"
#include "system/cli/cli_fixture.hpp"

namespace orchard::cli_test {
namespace {

using ::testing::HasSubstr;
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
  EXPECT_THAT(mapped.out, HasSubstr("16 landmarks: 12 trees, 4 objects"));

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
