// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/recording_csv.hpp"

#include <utility>

#include "geometry/angles.hpp"
#include "io/file_error.hpp"
#include "io/sane_limits.hpp"

namespace orchard::io {
namespace {

constexpr double kMaxIntensity = 1e9;
constexpr double kMaxSpeedMps = 100.0;
constexpr double kMaxYawRateRadps = 100.0;
constexpr std::int64_t kMaxUtime = std::int64_t{1} << 60;

/// The header must be utime_us followed by one column per beam.
void expect_beams(const CsvReader& csv, const LaserDescription& laser) {
  if (csv.columns().front() != "utime_us") {
    csv.fail_at_column(1, "the first line must be utime_us, followed by a column per beam");
  }
  const auto num_columns = static_cast<std::int64_t>(csv.columns().size());
  if (num_columns == laser.num_beams + 1) return;
  csv.fail_at_column(1, std::to_string(num_columns - 1) +
                            " columns after utime_us, but sensors.yaml says laser.num_beams: " +
                            std::to_string(laser.num_beams) + "; correct the one that is wrong");
}

}  // namespace

bool RecordingCsv::next_line() {
  if (!csv_.next()) return false;
  const std::int64_t utime = csv_.integer_in(0, 0, kMaxUtime);
  if (utime <= utime_) {
    csv_.fail(0, std::to_string(utime) + " is not later than " + std::to_string(utime_) +
                     " of the line before; sort the lines and remove duplicates");
  }
  utime_ = utime;
  ++seq_;
  return true;
}

ScanCsv::ScanCsv(CsvReader ranges, const LaserDescription& laser,
                 std::optional<CsvReader> intensities)
    : RecordingCsv(std::move(ranges)), laser_(laser), intensities_(std::move(intensities)) {
  expect_beams(csv_, laser_);
  if (intensities_) expect_beams(*intensities_, laser_);
}

std::optional<laser::Scan> ScanCsv::next() {
  if (!next_line()) {
    if (intensities_ && intensities_->next()) {
      intensities_->fail(0, "has more lines than the file of scans");
    }
    return std::nullopt;
  }
  laser::Scan scan;
  scan.utime = utime_;
  scan.seq = seq_;
  scan.bearing_min_rad = laser_.bearing_min_rad;
  scan.bearing_step_rad = laser_.bearing_step_rad;
  scan.beam_period_us = laser_.beam_period_us;
  scan.range_min_m = laser_.range_min_m;
  scan.range_max_m = laser_.range_max_m;
  scan.ranges_m.reserve(csv_.num_fields() - 1);
  for (std::size_t i = 1; i < csv_.num_fields(); ++i) {
    scan.ranges_m.push_back(static_cast<float>(csv_.number_in(i, 0.0, kMaxRange_m)));
  }
  if (intensities_) read_intensities(scan);
  return scan;
}

void ScanCsv::read_intensities(laser::Scan& scan) {
  if (!intensities_->next()) {
    csv_.fail(0, "the file of intensities has no line for this scan");
  }
  if (intensities_->integer(0) != scan.utime) {
    intensities_->fail(0, "must be the scan's " + std::to_string(scan.utime));
  }
  for (std::size_t i = 1; i < intensities_->num_fields(); ++i) {
    scan.intensities.push_back(static_cast<float>(intensities_->number_in(i, 0.0, kMaxIntensity)));
  }
}

OdometryCsv::OdometryCsv(CsvReader csv) : RecordingCsv(std::move(csv)) {
  csv_.expect_columns({"utime_us", "v_mps", "yaw_rate_radps"});
}

std::optional<pose::Odometry> OdometryCsv::next() {
  if (!next_line()) return std::nullopt;
  pose::Odometry odometry;
  odometry.utime = utime_;
  odometry.seq = seq_;
  odometry.speed_mps = csv_.number_in(1, -kMaxSpeedMps, kMaxSpeedMps);
  odometry.yaw_rate_radps = csv_.number_in(2, -kMaxYawRateRadps, kMaxYawRateRadps);
  return odometry;
}

GnssCsv::GnssCsv(CsvReader csv) : RecordingCsv(std::move(csv)) {
  csv_.expect_columns({"utime_us", "latitude_deg", "longitude_deg", "altitude_m"});
}

std::optional<pose::Gnss> GnssCsv::next() {
  if (!next_line()) return std::nullopt;
  pose::Gnss gnss;
  gnss.utime = utime_;
  gnss.seq = seq_;
  gnss.latitude_deg = csv_.number_in(1, -90.0, 90.0);
  gnss.longitude_deg = csv_.number_in(2, -180.0, 180.0);
  gnss.altitude_m = csv_.number_in(3, -1e4, 1e5);
  return gnss;
}

PoseFixCsv::PoseFixCsv(CsvReader csv) : RecordingCsv(std::move(csv)) {
  csv_.expect_columns({"utime_us", "x_m", "y_m", "yaw_rad"});
}

std::optional<pose::PoseFix> PoseFixCsv::next() {
  if (!next_line()) return std::nullopt;
  pose::PoseFix fix;
  fix.utime = utime_;
  fix.seq = seq_;
  fix.x_m = csv_.number_in(1, -kMaxCoordinate_m, kMaxCoordinate_m);
  fix.y_m = csv_.number_in(2, -kMaxCoordinate_m, kMaxCoordinate_m);
  fix.yaw_rad = geometry::wrap_angle_rad(csv_.number_in(3, -kMaxYaw_rad, kMaxYaw_rad));
  return fix;
}

}  // namespace orchard::io
