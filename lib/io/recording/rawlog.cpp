// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/rawlog.hpp"

#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/angles.hpp"
#include "io/confined.hpp"
#include "io/file_error.hpp"
#include "io/gz_file.hpp"
#include "io/recording/jpeg_file.hpp"
#include "io/sane_limits.hpp"

namespace orchard::io {
namespace {

using namespace mrpt::obs;
namespace fs = std::filesystem;

/// Reads the file once to verify the checksum of a compressed file, which MRPT does not check.
/// Returns the uncompressed size in bytes.
std::uint64_t checked_size(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw FileError(path + " is not a file; give an MRPT rawlog");
  }
  GzFile file(path, "rawlog");
  std::string buffer;
  while (file.read(buffer)) buffer.clear();
  const std::uint64_t size = file.num_read_bytes();
  if (size == 0) throw FileError(path + " is empty; give an MRPT rawlog");
  return size;
}

constexpr int kJpegQuality = 95;
constexpr double kMaxTiltRad = 0.05;

/// MRPT counts units of 100 ns since 1601.
std::optional<std::int64_t> utime_of(mrpt::system::TTimeStamp time) {
  constexpr std::int64_t kUnixEpochTicks = 116444736000000000;
  const std::int64_t ticks = static_cast<std::int64_t>(time.time_since_epoch().count());
  if (time == INVALID_TIMESTAMP || ticks < kUnixEpochTicks) return std::nullopt;
  return (ticks - kUnixEpochTicks) / 10;
}

std::string class_name(const mrpt::rtti::CObject& object) {
  return object.GetRuntimeClass()->className;
}

vision::Image encode(const cv::Mat& picture, const std::string& path) {
  vision::Image image;
  image.encoding = vision::Encoding::kJpeg;
  image.width_px = picture.cols;
  image.height_px = picture.rows;
  if (picture.empty() || picture.depth() != CV_8U ||
      !cv::imencode(".jpg", picture, image.data, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality})) {
    throw FileError(path + ": a picture in it is invalid; the rawlog may be damaged");
  }
  return image;
}

/// Converts MRPT's observations to messages, in the order of the rawlog.
class RawlogCollector {
 public:
  explicit RawlogCollector(const std::string& rawlog_path) : path_(rawlog_path) {}

  void add(const CObservation& observation) {
    const std::string name = class_name(observation);
    if (!utime_of(observation.timestamp)) return ignore(name + " (without time)");
    if (const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation)) {
      return add_scan(*scan);
    }
    if (const auto* image = dynamic_cast<const CObservationImage*>(&observation)) {
      return add_image(*image);
    }
    if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&observation)) {
      return add_odometry(*odometry);
    }
    if (const auto* gps = dynamic_cast<const CObservationGPS*>(&observation)) return add_gps(*gps);
    ignore(name);
  }
  void add(const CSensoryFrame& frame) {
    std::optional<std::int64_t> first_utime;
    for (const auto& observation : frame) {
      if (!observation) continue;
      if (!first_utime) first_utime = utime_of(observation->timestamp);
      add(*observation);
    }
    finish_movement(first_utime);
  }
  void add(const CActionCollection& actions) {
    finish_movement(std::nullopt);
    for (std::size_t i = 0; i < actions.size(); ++i) {
      const CAction& action = actions.get(i);
      const auto* source = dynamic_cast<const CActionRobotMovement2D*>(&action);
      if (source == nullptr || movement_) {
        ignore(class_name(action));
        continue;
      }
      Movement movement;
      movement.utime = utime_of(source->timestamp);
      mrpt::poses::CPose2D step = source->rawOdometryIncrementReading;
      if (source->estimationMethod != CActionRobotMovement2D::emOdometry && source->poseChange) {
        step = source->poseChange->getMeanVal();  // from scan matching: there is no raw reading
      }
      movement.forward_m = step.x();
      movement.turn_rad = step.phi();
      movement.has_velocity = source->hasVelocities;
      movement.speed_mps = source->velocityLocal.vx;
      movement.yaw_rate_radps = source->velocityLocal.omega;
      movement_ = movement;
    }
  }
  void ignore(const std::string& what) { ++content_.ignored[what]; }

  RawlogContent take() {
    finish_movement(std::nullopt);
    sort_and_number(content_.messages);
    return std::move(content_);
  }

 private:
  struct Movement {
    std::optional<std::int64_t> utime;
    double forward_m = 0.0;
    double turn_rad = 0.0;
    bool has_velocity = false;
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
  };

  void add_scan(const CObservation2DRangeScan& source) {
    const std::string name = class_name(source);
    const std::size_t num_beams = source.getScanSize();
    mrpt::poses::CPose3D pose = source.sensorPose;
    if (!content_.laser_mount) content_.laser_label = source.sensorLabel;
    if (source.sensorLabel != content_.laser_label) {
      return ignore(name + " of " + source.sensorLabel + " (only one laser is used)");
    }
    if (std::abs(pose.roll()) > kMaxTiltRad || std::abs(pose.pitch()) > kMaxTiltRad) {
      return ignore(name + " (not horizontal)");
    }
    if (num_beams < 2 || !(source.aperture > 0.0f) || !(source.aperture < 7.0f) ||
        !(source.maxRange > 0.0f) || !(source.maxRange <= kMaxRange_m)) {
      return ignore(name + " (inconsistent)");
    }
    if (!content_.laser_mount) content_.laser_mount = SensorMount{pose.x(), pose.y(), pose.yaw()};
    laser::Scan scan;
    scan.utime = *utime_of(source.timestamp);
    const double aperture_rad = source.aperture;
    const double direction = source.rightToLeft ? 1.0 : -1.0;
    scan.bearing_min_rad = -0.5 * direction * aperture_rad;
    scan.bearing_step_rad = direction * aperture_rad / static_cast<double>(num_beams - 1);
    scan.range_max_m = source.maxRange;
    scan.ranges_m.resize(num_beams, 0.0f);
    for (std::size_t i = 0; i < num_beams; ++i) {
      const float range_m = source.getScanRange(i);
      const bool usable = source.getScanRangeValidity(i) && range_m > 0.0f && range_m < kMaxRange_m;
      if (usable) scan.ranges_m[i] = range_m;
      if (source.hasIntensity()) {
        scan.intensities.push_back(static_cast<float>(source.getScanIntensity(i)));
      }
    }
    content_.messages.emplace_back(std::move(scan));
  }
  void add_image(const CObservationImage& source) {
    if (!has_camera_) content_.camera_label = source.sensorLabel;
    has_camera_ = true;
    if (source.sensorLabel != content_.camera_label) {
      return ignore(class_name(source) + " of " + source.sensorLabel +
                    " (only one camera is used)");
    }
    vision::Image image;
    if (source.image.isExternallyStored()) {
      const fs::path name(source.image.getExternalStorageFile());
      bool leaves = name.is_absolute();
      for (const fs::path& part : name) leaves = leaves || part == "..";
      const fs::path file = fs::path(CRawlog::detectImagesDirectory(path_)) / name;
      if (leaves || !fs::is_regular_file(file)) {
        throw FileError(path_ + ": its picture " + name.string() +
                        " is missing in its image folder; copy it there");
      }
      image = file.extension() == ".jpg" ? read_jpeg_file(file.string())
                                         : encode(cv::imread(file.string()), path_);
    } else {
      image = encode(source.image.asCvMatRef(), path_);
    }
    image.utime = *utime_of(source.timestamp);
    content_.messages.emplace_back(std::move(image));
  }
  void add_odometry(const CObservationOdometry& source) {
    const Place place{*utime_of(source.timestamp), source.odometry.x(), source.odometry.y(),
                      source.odometry.phi()};
    if (source.hasVelocities) {
      pose::Odometry odometry;
      odometry.utime = place.utime;
      odometry.speed_mps = source.velocityLocal.vx;
      odometry.yaw_rate_radps = source.velocityLocal.omega;
      content_.messages.emplace_back(odometry);
    } else if (last_place_ && place.utime > last_place_->utime) {
      const double dx = place.x_m - last_place_->x_m, dy = place.y_m - last_place_->y_m;
      const double turn_rad = geometry::wrap_angle_rad(place.yaw_rad - last_place_->yaw_rad);
      const double heading_rad = last_place_->yaw_rad + 0.5 * turn_rad;  // direction of the chord
      add_step(last_place_->utime, place.utime,
               dx * std::cos(heading_rad) + dy * std::sin(heading_rad), turn_rad);
    } else {
      ignore(class_name(source) + " (without a time step)");
    }
    last_place_ = place;
  }
  void add_gps(const CObservationGPS& source) {
    if (!source.hasMsgClass<gnss::Message_NMEA_GGA>()) {
      return ignore(class_name(source) + " (without GGA)");
    }
    const auto& fields = source.getMsgByClass<gnss::Message_NMEA_GGA>().fields;
    if (fields.fix_quality == 0) return ignore(class_name(source) + " (no fix)");
    pose::Gnss fix;
    fix.utime = *utime_of(source.timestamp);
    fix.latitude_deg = fields.latitude_degrees;
    fix.longitude_deg = fields.longitude_degrees;
    fix.altitude_m = fields.altitude_meters + fields.geoidal_distance;  // above the ellipsoid
    fix.fix_quality = static_cast<std::int8_t>(fields.fix_quality);
    const bool sane = std::abs(fix.latitude_deg) <= 90.0 && std::abs(fix.longitude_deg) <= 180.0 &&
                      std::isfinite(fix.altitude_m);
    if (!sane) return ignore(class_name(source) + " (inconsistent)");
    content_.messages.emplace_back(fix);
  }
  void finish_movement(std::optional<std::int64_t> utime) {
    if (!movement_) return;
    const Movement movement = *std::exchange(movement_, std::nullopt);
    if (movement.utime) utime = movement.utime;
    if (utime && movement.has_velocity) {
      pose::Odometry odometry;
      odometry.utime = *utime;
      odometry.speed_mps = movement.speed_mps;
      odometry.yaw_rate_radps = movement.yaw_rate_radps;
      content_.messages.emplace_back(odometry);
    } else if (utime && last_movement_utime_ && *utime > *last_movement_utime_) {
      add_step(*last_movement_utime_, *utime, movement.forward_m, movement.turn_rad);
    } else {
      ignore("CActionRobotMovement2D (without a time step)");
    }
    if (utime) last_movement_utime_ = utime;
  }
  void add_step(std::int64_t from_utime, std::int64_t to_utime, double forward_m, double turn_rad) {
    const double step_s = 1e-6 * static_cast<double>(to_utime - from_utime);
    pose::Odometry odometry;
    odometry.utime = to_utime;
    odometry.speed_mps = forward_m / step_s;
    odometry.yaw_rate_radps = turn_rad / step_s;
    content_.messages.emplace_back(odometry);
  }

  std::string path_;
  RawlogContent content_;
  bool has_camera_ = false;
  std::optional<Movement> movement_;  ///< waits for the time of its end
  std::optional<std::int64_t> last_movement_utime_;
  struct Place {
    std::int64_t utime;
    double x_m, y_m, yaw_rad;
  };
  std::optional<Place> last_place_;
};

void add(const mrpt::serialization::CSerializable::Ptr& object, RawlogCollector& collector) {
  if (!object) return;
  if (std::dynamic_pointer_cast<CObservationComment>(object)) return;
  if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object)) {
    collector.add(*frame);
  } else if (const auto actions = std::dynamic_pointer_cast<CActionCollection>(object)) {
    collector.add(*actions);
  } else if (const auto observation = std::dynamic_pointer_cast<CObservation>(object)) {
    collector.add(*observation);
  } else {
    collector.ignore(object->GetRuntimeClass()->className);
  }
}

void read_objects(const std::string& path, std::uint64_t size, RawlogCollector& collector) {
  std::uint64_t position = 0;
  try {
    mrpt::io::CFileGZInputStream stream(path);
    auto archive = mrpt::serialization::archiveFrom(stream);
    while (position < size) {
      add(archive.ReadObject(), collector);
      const std::uint64_t end = stream.getPosition();
      if (end <= position) throw std::runtime_error("the data is incomplete");
      position = end;
    }
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw FileError(path + ": damaged at byte " + std::to_string(position) +
                    " (an object is larger than the file); copy it again");
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    constexpr std::size_t kShownBytes = 200;  // MRPT appends its call stack
    throw FileError(path + ": cannot be read at byte " + std::to_string(position) + " (" +
                    reason.substr(0, std::min(reason.find('\n'), kShownBytes)) +
                    "); give a complete MRPT rawlog");
  }
}

/// Reads the file in a confined process first, because MRPT crashes on some damage (a class name
/// changed to another). Throws FileError.
void require_readable(const std::string& path, std::uint64_t size) {
  read_confined(path, size, [&] {
    RawlogCollector collector(path);
    read_objects(path, size, collector);
    return std::string();
  });
}

}  // namespace

RawlogContent read_rawlog(const std::string& path) {
  const std::uint64_t size = checked_size(path);
  require_readable(path, size);
  RawlogCollector collector(path);
  read_objects(path, size, collector);
  RawlogContent content = collector.take();
  if (content.messages.empty()) {
    std::string found;
    for (const auto& [name, count] : content.ignored) {
      found += (found.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    }
    throw FileError(path + " has no usable observation, only " +
                    (found.empty() ? "comments" : found));
  }
  return content;
}

}  // namespace orchard::io
