// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/recording_folder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config_file.hpp"
#include "io/config/config_yaml.hpp"
#include "io/file_error.hpp"
#include "io/recording/jpeg_file.hpp"
#include "io/sane_limits.hpp"

namespace orchard::io {

constexpr double kTurn_rad = 2.0 * geometry::kPi + 1e-6;

/// Keys of the section `mount`; all or none.
static void describe(ConfigVisitor& v, SensorMount& m) {
  v.number("x_m", m.x_m, -100.0, 100.0, "m", "");
  v.number("y_m", m.y_m, -100.0, 100.0, "m", "");
  v.number("yaw_rad", m.yaw_rad, -kTurn_rad, kTurn_rad, "rad", "");
  const int num_given = !std::isnan(m.x_m) + !std::isnan(m.y_m) + !std::isnan(m.yaw_rad);
  v.check(num_given == 0 || num_given == 3, "x_m", "must be given with y_m and yaw_rad");
}

static void describe(ConfigVisitor& v, LaserDescription& l) {
  v.integer("num_beams", l.num_beams, 1, 100000, "", "");
  v.number("bearing_min_rad", l.bearing_min_rad, -kTurn_rad, kTurn_rad, "rad", "");
  v.number("bearing_step_rad", l.bearing_step_rad, -1.0, 1.0, "rad", "");
  v.number("range_min_m", l.range_min_m, 0.0, kMaxRange_m, "m", "");
  v.number("range_max_m", l.range_max_m, 0.0, kMaxRange_m, "m", "");
  v.number("beam_period_us", l.beam_period_us, -1e6, 1e6, "us", "");
  v.section("mount", l.mount, "");
  v.check(l.num_beams > 0, "num_beams", "is missing; add it");
  v.check(!std::isnan(l.bearing_min_rad), "bearing_min_rad", "is missing; add it");
  v.check(!std::isnan(l.bearing_step_rad), "bearing_step_rad", "is missing; add it");
  v.check(!std::isnan(l.range_min_m), "range_min_m", "is missing; add it");
  v.check(!std::isnan(l.range_max_m), "range_max_m", "is missing; add it");
  v.check(l.bearing_step_rad != 0.0, "bearing_step_rad", "must not be 0");
  v.check(!(l.range_max_m <= l.range_min_m), "range_max_m", "must be above range_min_m");
}

namespace {

namespace fs = std::filesystem;
using Source = std::function<std::optional<SensorMessage>()>;

constexpr double kMaxIntensity = 1e9;

/// Turns a scan whose last beam was measured first: the same returns, the first in time first.
void put_in_order_of_time(laser::Scan& scan) {
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  std::reverse(scan.intensities.begin(), scan.intensities.end());
  const auto last = static_cast<double>(scan.ranges_m.size() - 1);
  scan.bearing_min_rad = scan.bearing_rad(last);
  scan.bearing_step_rad = -scan.bearing_step_rad;
  scan.beam_period_us = -scan.beam_period_us;
}

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

/// Opens the table of that name, plain or compressed; none if neither exists.
std::optional<CsvReader> open_table(const fs::path& folder, const std::string& name) {
  const fs::path plain = folder / (name + ".csv");
  const fs::path compressed = folder / (name + ".csv.gz");
  const bool has_plain = fs::exists(plain), has_compressed = fs::exists(compressed);
  if (has_plain && has_compressed) {
    throw FileError(plain.string() + " exists beside " + compressed.filename().string() +
                    "; remove one of them");
  }
  if (has_plain) return CsvReader::open(plain.string());
  if (has_compressed) return CsvReader::open(compressed.string());
  return std::nullopt;
}

template <class Table>
Source table_source(Table given) {
  return [table = std::make_shared<Table>(std::move(given))]() -> std::optional<SensorMessage> {
    if (auto message = table->next()) return SensorMessage(std::move(*message));
    return std::nullopt;
  };
}

Source image_source(std::vector<TimedJpeg> files) {
  return [files = std::move(files), i = std::size_t{0}]() mutable -> std::optional<SensorMessage> {
    if (i == files.size()) return std::nullopt;
    vision::Image image = read_jpeg_file(files[i].path);
    image.utime = files[i].utime;
    image.seq = static_cast<std::int32_t>(i++);
    return SensorMessage(std::move(image));
  };
}

/// Reads a recording folder's sensors.yaml (section laser: num_beams, bearing_min_rad,
/// bearing_step_rad, range_min_m, range_max_m, and if known beam_period_us and mount). Throws
/// FileError naming file, line and key of each error, including unknown keys.
LaserDescription read_sensors(const std::string& path) {
  constexpr std::size_t kBytesMax = std::size_t{1} << 20;
  LaserDescription laser;
  laser.bearing_min_rad = laser.bearing_step_rad = laser.range_min_m = laser.range_max_m = NAN;
  laser.mount = {NAN, NAN, NAN};
  const std::string text =
      read_file(path, kBytesMax, "a recording folder needs this file with the laser's parameters");
  try {
    read_yaml(text, path, [&](ConfigVisitor& v) { v.section("laser", laser, ""); });
  } catch (const ConfigError& error) {
    throw FileError(error.what());
  }
  if (std::isnan(laser.mount.x_m)) laser.mount = {};
  return laser;
}

}  // namespace

void sort_and_number(std::vector<SensorMessage>& messages) {
  std::stable_sort(messages.begin(), messages.end(),
                   [](const SensorMessage& a, const SensorMessage& b) {
                     const std::int64_t time_a = utime_of(a), time_b = utime_of(b);
                     return time_a != time_b ? time_a < time_b : a.index() < b.index();
                   });
  std::array<std::int32_t, std::variant_size_v<SensorMessage>> next_seq{};
  for (SensorMessage& message : messages) {
    const std::int32_t seq = next_seq[message.index()]++;
    std::visit([seq](auto& m) { m.seq = seq; }, message);
  }
}

ScanCsv::ScanCsv(CsvReader ranges, const LaserDescription& laser,
                 std::optional<CsvReader> intensities)
    : csv_(std::move(ranges)), laser_(laser), intensities_(std::move(intensities)) {
  expect_beams(csv_, laser_);
  if (intensities_) expect_beams(*intensities_, laser_);
}

std::optional<laser::Scan> ScanCsv::next() {
  if (!csv_.next()) {
    if (intensities_ && intensities_->next()) {
      intensities_->fail(0, "has more lines than the file of scans");
    }
    return std::nullopt;
  }
  laser::Scan scan;
  scan.utime = utime_ = csv_.later_utime(0, utime_);
  scan.seq = ++seq_;
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
  if (scan.beam_period_us < 0.0) put_in_order_of_time(scan);
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

TimedCsv<pose::Odometry> odometry_csv(CsvReader csv) {
  return {std::move(csv),
          {{"v_mps", &pose::Odometry::speed_mps, -100.0, 100.0},
           {"yaw_rate_radps", &pose::Odometry::yaw_rate_radps, -100.0, 100.0}}};
}

TimedCsv<pose::Gnss> gnss_csv(CsvReader csv) {
  return {std::move(csv),
          {{"latitude_deg", &pose::Gnss::latitude_deg, -90.0, 90.0},
           {"longitude_deg", &pose::Gnss::longitude_deg, -180.0, 180.0},
           {"altitude_m", &pose::Gnss::altitude_m, -1e4, 1e5}}};
}

TimedCsv<pose::PoseFix> pose_fix_csv(CsvReader csv) {
  return {std::move(csv), pose_columns<pose::PoseFix>()};
}

struct RecordingFolder::Impl {
  LaserDescription laser;
  std::vector<Source> sources;  ///< in the order of SensorMessage's alternatives
  std::vector<std::optional<SensorMessage>> heads;
};

RecordingFolder::RecordingFolder(const std::string& path) : impl_(std::make_unique<Impl>()) {
  const fs::path folder(path);
  if (!fs::is_directory(folder)) {
    throw FileError(path + " is not a folder; give a recording folder with sensors.yaml");
  }
  impl_->laser = read_sensors((folder / "sensors.yaml").string());
  auto scans = open_table(folder, "scans");
  if (!scans) throw FileError(path + " has neither scans.csv nor scans.csv.gz; add one");
  impl_->sources.push_back(
      table_source(ScanCsv(std::move(*scans), impl_->laser, open_table(folder, "intensities"))));
  impl_->sources.push_back(
      image_source(list_jpegs((folder / "images").string(), OtherFiles::kRefuse)));
  if (auto csv = open_table(folder, "odometry")) {
    impl_->sources.push_back(table_source(odometry_csv(std::move(*csv))));
  }
  if (auto csv = open_table(folder, "gnss")) {
    impl_->sources.push_back(table_source(gnss_csv(std::move(*csv))));
  }
  if (auto csv = open_table(folder, "poses")) {
    impl_->sources.push_back(table_source(pose_fix_csv(std::move(*csv))));
  }
  for (Source& source : impl_->sources) impl_->heads.push_back(source());
}

RecordingFolder::~RecordingFolder() = default;

const LaserDescription& RecordingFolder::laser() const { return impl_->laser; }

std::optional<SensorMessage> RecordingFolder::next() {
  std::size_t first = impl_->heads.size();
  for (std::size_t i = 0; i < impl_->heads.size(); ++i) {
    if (!impl_->heads[i]) continue;
    if (first == impl_->heads.size() ||
        utime_of(*impl_->heads[i]) < utime_of(*impl_->heads[first])) {
      first = i;
    }
  }
  if (first == impl_->heads.size()) return std::nullopt;
  std::optional<SensorMessage> message = std::move(impl_->heads[first]);
  impl_->heads[first] = impl_->sources[first]();
  return message;
}

std::vector<SensorMessage> read_recording_folder(const std::string& path) {
  RecordingFolder folder(path);
  std::vector<SensorMessage> messages;
  while (auto message = folder.next()) messages.push_back(std::move(*message));
  return messages;
}

}  // namespace orchard::io
