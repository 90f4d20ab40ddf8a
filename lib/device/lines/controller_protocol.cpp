// SPDX-License-Identifier: BSD-3-Clause
#include "device/lines/controller_protocol.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>
#include <variant>

namespace orchard::device {
namespace {

constexpr std::size_t kLongestLine_bytes = 200;
constexpr std::int64_t kSilence_us = 1'000'000;
constexpr std::int64_t kGiveUp_us = 10'000'000;  // a controller boots in less
constexpr std::size_t kShownBytes = 40;

using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Yaw about z, then pitch about y, then roll about x.
Matrix rotation(const std::array<double, 3>& rpy_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(rpy_rad[2], Vector3d::UnitZ()) * AngleAxisd(rpy_rad[1], Vector3d::UnitY()) *
          AngleAxisd(rpy_rad[0], Vector3d::UnitX()))
      .toRotationMatrix();
}

std::array<double, 3> rotated(const Matrix& R, const std::array<double, 3>& vector) {
  const Eigen::Vector3d turned = R * Eigen::Map<const Eigen::Vector3d>(vector.data());
  return {turned.x(), turned.y(), turned.z()};
}

/// What a person can read of any bytes.
std::string shown(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes.substr(0, kShownBytes)) {
    text += byte >= ' ' && byte <= '~' ? byte : '?';
  }
  return text + (bytes.size() > kShownBytes ? "..." : "");
}

}  // namespace

ControllerProtocol::ControllerProtocol(const OdometryDriverConfig& odometry,
                                       const ImuDriverConfig& imu)
    : lines_(kLongestLine_bytes), ticks_(odometry), clock_(32, 1.0) {
  const Matrix R = rotation(imu.mount_rad);
  std::copy_n(R.data(), R_base_imu_.size(), R_base_imu_.begin());
}

void ControllerProtocol::connected(std::int64_t host_utime) {
  lines_.restart(true);
  ticks_.restart();
  clock_.begin_connection();
  needs_checksum_ = false;
  is_given_up_ = false;
  is_silent_ = true;
  heard_utime_ = host_utime;
  deadline_ = host_utime + kSilence_us;
}

void ControllerProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  lines_.add(bytes, [&](std::string_view line) { take_line(line, host_utime); });
}

void ControllerProtocol::expire(std::int64_t host_utime) {
  is_silent_ = true;
  is_given_up_ = host_utime - heard_utime_ >= kGiveUp_us;
  deadline_ = host_utime + kSilence_us;
}

void ControllerProtocol::host_clock_stepped(std::int64_t step_us) {
  clock_.host_stepped(step_us);
  if (!ticks_by_device_clock_) ticks_.shift_time(step_us);
  heard_utime_ += step_us;
  odometry_utime_ += step_us;
  imu_utime_ += step_us;
  if (deadline_) *deadline_ += step_us;
}

std::string ControllerProtocol::failure() const {
  return is_given_up_ ? "no valid line for 10 s" : "";
}

std::string ControllerProtocol::condition() const {
  if (!is_silent_) return {};
  if (!last_refused_.empty()) return "waits for a valid line; refused \"" + last_refused_ + ")";
  return "waits for lines; check that the controller is running and the baud rate is right";
}

ProtocolCounts ControllerProtocol::counts() const {
  ProtocolCounts counts = counts_;
  counts.num_bad += lines_.num_too_long();
  return counts;
}

void ControllerProtocol::take_line(std::string_view text, std::int64_t host_utime) {
  const auto parsed = parse_sensor_line(text);
  if (const auto* bad = std::get_if<BadLine>(&parsed)) return refuse(text, bad->why);
  const auto* line = std::get_if<SensorLine>(&parsed);
  if (line == nullptr) return;
  if (needs_checksum_ && !line->has_checksum) return refuse(text, "its checksum is missing");
  needs_checksum_ = line->has_checksum;
  if (const std::string why = use(*line, host_utime); !why.empty()) return refuse(text, why);
  ++counts_.num_good;
  last_refused_.clear();
  is_silent_ = false;
  heard_utime_ = host_utime;
  deadline_ = host_utime + kSilence_us;
}

void ControllerProtocol::refuse(std::string_view text, const std::string& why) {
  ++counts_.num_bad;
  last_refused_ = shown(text) + "\" (" + shown(why);
}

std::string ControllerProtocol::use(const SensorLine& line, std::int64_t host_utime) {
  double time_us = 0.0;
  std::int64_t utime = host_utime;
  if (line.device_time_us) {
    time_us = clock_.arrived(static_cast<std::uint32_t>(*line.device_time_us), host_utime);
    utime = clock_.host_utime(time_us);
    if (clock_.num_restarts() != num_restarts_) {
      num_restarts_ = clock_.num_restarts();
      ticks_.restart();
    }
  }
  if (const auto* velocity = std::get_if<VelocityLine>(&line.content)) {
    add_velocity(*velocity, utime);
  } else if (const auto* ticks = std::get_if<TickLine>(&line.content)) {
    return add_ticks(line, *ticks, time_us, utime);
  } else {
    add_inertial(std::get<InertialLine>(line.content), utime);
  }
  return {};
}

void ControllerProtocol::add_velocity(const VelocityLine& line, std::int64_t utime) {
  pose::Odometry odometry;
  odometry.utime = utime;
  odometry.speed_mps = line.speed_mps;
  odometry.yaw_rate_radps = line.yaw_rate_radps;
  odometry.covariance = {line.speed_sd_mps * line.speed_sd_mps, 0.0,
                         line.yaw_rate_sd_radps * line.yaw_rate_sd_radps};
  add(odometry, odometry_utime_);
}

std::string ControllerProtocol::add_ticks(const SensorLine& line, const TickLine& ticks,
                                          double time_us, std::int64_t utime) {
  const bool by_device_clock = line.device_time_us.has_value();
  if (by_device_clock != ticks_by_device_clock_) ticks_.restart();
  ticks_by_device_clock_ = by_device_clock;
  // The controller's own clock gives the step without the jitter of the line.
  const auto outcome = ticks_.add(ticks, by_device_clock ? std::llround(time_us) : utime);
  if (outcome == WheelTicks::Outcome::kJumped) return "a jump larger than a wheel can turn";
  if (outcome == WheelTicks::Outcome::kNoTime && by_device_clock) {
    return "its time is not later than that of the previous line";
  }
  if (outcome != WheelTicks::Outcome::kMoved) return {};
  pose::Odometry odometry = ticks_.odometry();
  if (by_device_clock) odometry.utime = clock_.host_utime(static_cast<double>(odometry.utime));
  add(odometry, odometry_utime_);
  return {};
}

void ControllerProtocol::add_inertial(const InertialLine& line, std::int64_t utime) {
  const Matrix R_base_imu = Eigen::Map<const Matrix>(R_base_imu_.data());
  pose::Imu imu;
  imu.utime = utime;
  imu.angular_rate_radps = rotated(R_base_imu, line.angular_rate_radps);
  imu.acceleration_mps2 = rotated(R_base_imu, line.acceleration_mps2);
  imu.has_orientation = line.has_orientation;
  if (line.has_orientation) {
    const Matrix R = rotation(line.orientation_rad) * R_base_imu.transpose();
    imu.roll_rad = std::atan2(R(2, 1), R(2, 2));
    imu.pitch_rad = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
    imu.yaw_rad = std::atan2(R(1, 0), R(0, 0));
  }
  add(imu, imu_utime_);
}

template <class M>
void ControllerProtocol::add(M measurement, std::int64_t& last_utime) {
  // Stamps only rise, also when lines arrive together or the clock's line is fitted anew.
  if (measurement.utime <= last_utime) measurement.utime = last_utime + 1;
  last_utime = measurement.utime;
  measurements_.emplace_back(measurement);
}

}  // namespace orchard::device
