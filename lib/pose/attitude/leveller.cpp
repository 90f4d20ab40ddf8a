// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/leveller.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "timing/units.hpp"

namespace orchard::pose {
namespace {

// physical: without wheels the speed is unknown; robots in orchards drive at a walking pace.
constexpr double kWalk_mps = 1.0;

timing::OrderedQueue<Leveller::Input, 4>::Rules rules_of(const LevellingConfig& config) {
  timing::OrderedQueue<Leveller::Input, 4>::Rules rules;
  rules[0].wait_us = timing::microseconds(config.wait_s);
  if (config.has_wheels) rules[1].wait_us = timing::microseconds(config.wait_s);
  return rules;
}

std::int64_t last_beam_utime(const laser::Scan& scan) {
  const double num_periods = std::max<double>(1.0, static_cast<double>(scan.ranges_m.size())) - 1.0;
  return scan.utime + std::llround(num_periods * scan.beam_period_us);
}

/// physical: no robot drives on its side; a tilt of more than 45 degrees is none.
bool is_upright(const Attitude& a) { return std::cos(a.roll_rad) * std::cos(a.pitch_rad) > 0.7; }

std::int64_t turn_of(const Imu& imu) { return imu.utime; }
std::int64_t turn_of(const Odometry& odometry) { return odometry.utime; }
std::int64_t turn_of(const laser::Scan& scan) { return last_beam_utime(scan); }

}  // namespace

Leveller::Leveller(const LevellingConfig& config)
    : config_(config),
      queue_(rules_of(config)),
      ground_(config.objects.range_max_m),
      front_(config.laser, config.objects.jump_m, config.objects.jump_fraction),
      rear_(config.laser_rear, config.objects.jump_m, config.objects.jump_fraction),
      speed_mps_(config.has_wheels ? 0.0 : kWalk_mps) {}

void Leveller::add(Input input) {
  const std::int64_t utime = std::visit([](const auto& m) { return turn_of(m); }, input);
  const std::size_t kind = input.index();
  queue_.push(kind, utime, std::move(input));
}

std::optional<Leveller::Input> Leveller::take() {
  std::optional<Input> next = queue_.pop();
  if (!next) return std::nullopt;
  return levelled(*std::move(next));
}

std::optional<Leveller::Input> Leveller::take_flushed() {
  std::optional<Input> next = queue_.pop_flushed();
  if (!next) return std::nullopt;
  return levelled(*std::move(next));
}

Leveller::Input Leveller::levelled(Input input) {
  std::visit([this](auto& m) { level(m); }, input);
  return input;
}

void Leveller::level(Imu& imu) {
  attitude_.add(imu);
  const std::optional<Attitude> attitude = attitude_.at(imu.utime);
  if (!attitude || !is_upright(*attitude)) return;
  if (imu_utime_ && imu.utime > *imu_utime_) {
    const double time_s = std::min(1.0, timing::seconds(imu.utime - *imu_utime_));
    ground_.add(*attitude, std::abs(speed_mps_) * time_s, attitude_.heading_rate_radps() * time_s);
  } else if (!imu_utime_) {
    ground_.add(*attitude, 0.0, 0.0);
  }
  imu_utime_ = imu.utime;
  imu.angular_rate_radps[2] =
      heading_rate_radps(*attitude, imu.angular_rate_radps[1], imu.angular_rate_radps[2]);
}

void Leveller::level(Odometry& odometry) {
  attitude_.add(odometry);
  if (config_.has_wheels) speed_mps_ = odometry.speed_mps;
  const std::optional<Attitude> attitude = attitude_.at(odometry.utime);
  if (!attitude || !is_upright(*attitude)) return;
  odometry.speed_mps *= std::cos(attitude->pitch_rad);
  odometry.yaw_rate_radps = heading_rate_radps(*attitude, 0.0, odometry.yaw_rate_radps);
}

void Leveller::level(laser::Scan& scan) { level(scan, front_); }
void Leveller::level(laser::RearScan& scan) { level(scan, rear_); }

void Leveller::level(laser::Scan& scan, ScanLeveller& leveller) {
  if (scan.ranges_m.empty()) return;  // of which only the time is used
  ++num_scans_;
  const std::optional<Attitude> first = attitude_.at(scan.utime);
  const std::optional<Attitude> last = attitude_.at(last_beam_utime(scan));
  if (first && last && is_upright(*first) && is_upright(*last)) {
    leveller.level(scan, *first, *last, ground_);
  } else {
    ++num_unlevelled_;
  }
}

std::string Leveller::warning() const {
  if (num_unlevelled_ == 0) return {};
  return "no upright tilt by an IMU (from the imu driver) for " + std::to_string(num_unlevelled_) +
         " of " + std::to_string(num_scans_) +
         " scans: they are taken as level, and returns of the ground as objects; without an IMU "
         "set laser.height_m to 0";
}

}  // namespace orchard::pose
